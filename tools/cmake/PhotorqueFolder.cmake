# Files of one room (a folder that holds sources) are compiled together, in batches of at most
# `max_kB` (smaller in the rooms named after the target): most of a file's compile time goes into headers, which a batch reads once. Names in
# anonymous namespaces must therefore differ within a room. OFF suits daily work on a few files.
option(PHOTORQUE_UNITY "Compile the files of a room together" OFF)
function(photorque_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${PHOTORQUE_UNITY} UNITY_BUILD_MODE GROUP)
  if(NOT PHOTORQUE_UNITY)
    return()
  endif()
  get_target_property(files ${target} SOURCES)
  foreach(file IN LISTS files)
    get_source_file_property(alone ${file} SKIP_UNITY_BUILD_INCLUSION)
    cmake_path(ABSOLUTE_PATH file BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE path)
    if(alone OR NOT path MATCHES "\\.cpp$" OR NOT EXISTS ${path})
      continue()
    endif()
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${CMAKE_SOURCE_DIR} OUTPUT_VARIABLE room)
    cmake_path(GET room PARENT_PATH room)
    set(max_kB 140)
    if(room IN_LIST ARGN)
      set(max_kB 30)
    endif()
    string(MAKE_C_IDENTIFIER "${room}" room)
    file(SIZE ${path} bytes)
    math(EXPR sum_${room} "0${sum_${room}} + ${bytes}")
    math(EXPR batch "${sum_${room}} / (1024 * ${max_kB})")
    set_source_files_properties(${file} PROPERTIES UNITY_GROUP "${room}_${batch}")
  endforeach()
  # A local name may be that of another file's constant.
  target_compile_options(${target} PRIVATE -Wno-shadow)
endfunction()

# The standard library and Eigen, compiled once for all libraries; programs are no shared code (-fPIE).
function(photorque_precompiled target)
  get_target_property(type ${target} TYPE)
  if(target STREQUAL photorque_core OR type STREQUAL EXECUTABLE)
    target_precompile_headers(${target} PRIVATE ${CMAKE_SOURCE_DIR}/core/precompiled.h)
  else()
    target_precompile_headers(${target} REUSE_FROM photorque_core)
  endif()
endfunction()

# photorque_folder(NAME [FILES file ...] [WITHOUT path ...] [USES folder ...] [LINKS library ...] [ALONE file ...]
#                  [QUICK room ...])
#   One static library photorque_NAME for a top-level folder: FILES, or every source below the folder
#   but those whose path begins with one of WITHOUT. USES names the folders it may include (public), LINKS the outside libraries that only
#   this folder may see (private), ALONE the files that cannot be compiled together with others,
#   QUICK the rooms with smaller batches, whose files change often.
function(photorque_folder name)
  cmake_parse_arguments(arg "" "" "FILES;WITHOUT;USES;LINKS;ALONE;QUICK" ${ARGN})
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
