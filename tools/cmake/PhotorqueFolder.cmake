# Files of a target are compiled in batches: most of the compile time of a file is spent on headers, which a batch
# reads once. A room (a folder that contains sources) of 70 kB or more has its own batches. The smaller rooms of a
# target share batches. The rooms listed as further arguments share smaller batches. Names in anonymous namespaces must
# therefore differ within a batch. OFF is useful for daily work on a few files.
option(PHOTORQUE_UNITY "Compile the files of a room together" OFF)
function(photorque_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PHOTORQUE_UNITY} UNITY_BUILD_MODE GROUP)
  if(NOT PHOTORQUE_UNITY)
    return()
  endif()
  get_target_property(files ${target} SOURCES)
  set(together "")
  foreach(file IN LISTS files)
    get_source_file_property(alone ${file} SKIP_UNITY_BUILD_INCLUSION)
    cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE path)
    if(alone OR NOT path MATCHES "\\.cpp$" OR NOT EXISTS ${path})
      continue()
    endif()
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE room)
    cmake_path(GET room PARENT_PATH room)
    file(SIZE ${path} bytes_${file})
    math(EXPR room_${room} "0${room_${room}} + ${bytes_${file}}")
    set(room_of_${file} ${room})
    list(APPEND together ${file})
  endforeach()
  foreach(file IN LISTS together)
    set(room ${room_of_${file}})
    if(room IN_LIST ARGN)
      set(group quick)
    elseif(room_${room} LESS 70000)
      set(group small_rooms)
    else()
      string(MAKE_C_IDENTIFIER "${room}" group)
    endif()
    set(group_of_${file} ${group})
    math(EXPR all_${group} "0${all_${group}} + ${bytes_${file}}")
  endforeach()
  foreach(file IN LISTS together)  # batches of equal size
    set(group ${group_of_${file}})
    set(max_bytes 160000)
    if(group STREQUAL "quick")
      set(max_bytes 50000)
    endif()
    math(EXPR batch "0${sum_${group}} * (${all_${group}} / ${max_bytes} + 1) / (${all_${group}} + 1)")
    math(EXPR sum_${group} "0${sum_${group}} + ${bytes_${file}}")
    set_source_files_properties(${file} PROPERTIES UNITY_GROUP "${group}_${batch}")
  endforeach()
  # A local name may equal a constant of another file.
  target_compile_options(${target} PRIVATE -Wno-shadow)
endfunction()

# The standard library and Eigen, compiled once for all libraries and programs.
function(photorque_precompiled target)
  if(target STREQUAL photorque_core)
    target_precompile_headers(${target} PRIVATE ${CMAKE_SOURCE_DIR}/core/precompiled.h)
  else()
    target_precompile_headers(${target} REUSE_FROM photorque_core)
    get_target_property(type ${target} TYPE)
    if(type STREQUAL EXECUTABLE)
      target_compile_options(${target} PRIVATE -fPIC)  # a precompiled header is valid for one kind of code
    endif()
  endif()
endfunction()

# For targets without numerical kernels: GCC compiles them faster without its costly passes. Sums are rounded as
# elsewhere (multiply-add belongs to the expensive optimisations). Clang gains little, and its precompiled header is
# valid for one level only.
function(photorque_cold target)
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1 -fexpensive-optimizations>)
  endif()
endfunction()

# photorque_folder(NAME [FILES file ...] [WITHOUT path ...] [USES folder ...] [LINKS library ...] [ALONE file ...]
#                  [QUICK room ...] [COLD])
#   One static library photorque_NAME for a top-level folder: FILES, or every source below the folder
#   but those whose path begins with one of WITHOUT. USES names the folders it may include (public), LINKS the outside libraries that only
#   this folder may see (private), ALONE the files that cannot be compiled together with others,
#   QUICK the rooms with smaller batches, whose files change often, COLD that no kernel is here.
function(photorque_folder name)
  cmake_parse_arguments(arg "COLD" "" "FILES;WITHOUT;USES;LINKS;ALONE;QUICK" ${ARGN})
  if(NOT arg_FILES)
    file(GLOB_RECURSE arg_FILES CONFIGURE_DEPENDS RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} *.cpp)
    foreach(path IN LISTS arg_WITHOUT)
      list(FILTER arg_FILES EXCLUDE REGEX "^${path}")
    endforeach()
    list(APPEND arg_FILES ${${name}_REGISTRY})
  endif()
  set_source_files_properties(${arg_ALONE} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  set(target photorque_${name})
  add_library(${target} STATIC ${arg_FILES})
  target_include_directories(${target} PUBLIC ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
  target_link_libraries(${target} PUBLIC Eigen3::Eigen)
  foreach(used IN LISTS arg_USES)
    target_link_libraries(${target} PUBLIC photorque_${used})
  endforeach()
  target_link_libraries(${target} PRIVATE ${arg_LINKS})
  photorque_precompiled(${target})
  if(arg_COLD)
    photorque_cold(${target})
  endif()
  photorque_unity(${target} ${arg_QUICK})
endfunction()

# photorque_kinds(FOLDER TYPE HEADER word ...)
#   The registry of a folder. Each WORD, such as lamps/led, is one file FOLDER/WORD.cpp that defines
#   `TYPE photorque::kinds::led::kind()` (of the type Verb: `photorque::verbs::trace::kind()`). Generates a source with `std::vector<TYPE> all_TYPEs()` in
#   this order, which HEADER declares. Explicit calls, because objects that register themselves are
#   dropped by the linker from a static library.
function(photorque_kinds folder type header)
  set(space kinds)
  if(type STREQUAL Verb)
    set(space verbs)
  endif()
  set(declarations "")
  set(calls "")
  foreach(word IN LISTS ARGN)
    get_filename_component(kind ${word} NAME)
    string(APPEND declarations "namespace ${space}::${kind} {\n${type} kind();\n}\n")
    string(APPEND calls "      ${space}::${kind}::kind(),\n")
    list(APPEND files ${word}.cpp)
  endforeach()
  string(REGEX REPLACE "([a-z])([A-Z])" "\\1_\\2" snake "${type}")
  string(TOLOWER "${snake}" snake)
  set(generated ${CMAKE_BINARY_DIR}/generated/${folder}/${snake}_registry.cpp)
  # A program may link a registry that replaces that of the library.
  set_source_files_properties(${generated} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
  file(CONFIGURE OUTPUT ${generated} CONTENT
"// Generated from ${folder}/CMakeLists.txt: one line per kind.
#include \"${header}\"

namespace photorque {
${declarations}
std::vector<${type}> all_${snake}s() {
  return {
${calls}  };
}
}  // namespace photorque
" @ONLY)
  set(${folder}_KINDS ${files} ${generated} PARENT_SCOPE)
  set(${folder}_REGISTRY ${generated} PARENT_SCOPE)
  set_property(GLOBAL PROPERTY photorque_words_${type} ${ARGN})
endfunction()
