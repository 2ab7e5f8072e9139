# Compiler settings of all targets.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Programs of the build tree search libraries in the same places as installed ones. CMake ends its own search paths
# with a colon. The loader interprets the empty entry after it as the current folder, and would load libraries
# beside a foreign model.
set(CMAKE_BUILD_WITH_INSTALL_RPATH ON)

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, Debug" FORCE)
endif()
# NDEBUG disables Eigen's assertions; the checks of this project are exceptions and remain.
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
set(CMAKE_CXX_FLAGS_DEBUG "-O1 -g")

option(PHOTORQUE_WERROR "Warnings are errors" ON)
option(PHOTORQUE_SANITIZE "AddressSanitizer and UndefinedBehaviorSanitizer" OFF)

add_compile_options(-Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual)
if(PHOTORQUE_WERROR)
  add_compile_options(-Werror)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # The compiler collects garbage only above 1 GB: a tenth less time for 0.3 GB more memory.
  add_compile_options("SHELL:--param ggc-min-heapsize=1000000")
  # GCC 12 reports these inside Eigen's and the standard library's inlined code.
  add_compile_options(-Wno-maybe-uninitialized -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread
                      -Wno-restrict -Wno-psabi)
endif()

# One fixed instruction set (AVX2 and FMA, since 2013) instead of the machine's own: the same binary gives the same
# bits on every machine. Empty means the compiler's default.
include(CheckCXXSourceRuns)
set(CMAKE_REQUIRED_FLAGS "-march=x86-64-v3")
check_cxx_source_runs("int main() { return __builtin_cpu_supports(\"avx2\") && __builtin_cpu_supports(\"fma\") ? 0 : 1; }"
                      PHOTORQUE_MACHINE_HAS_AVX2)
unset(CMAKE_REQUIRED_FLAGS)
if(PHOTORQUE_MACHINE_HAS_AVX2)
  set(PHOTORQUE_ARCH_DEFAULT "x86-64-v3")
endif()
set(PHOTORQUE_ARCH "${PHOTORQUE_ARCH_DEFAULT}" CACHE STRING "Instruction set (-march)")
if(PHOTORQUE_ARCH)
  add_compile_options(-march=${PHOTORQUE_ARCH})
  include(CheckCXXSourceCompiles)
  string(MAKE_C_IDENTIFIER "PHOTORQUE_AVX512_IN_${PHOTORQUE_ARCH}" has_avx512)
  set(CMAKE_REQUIRED_FLAGS "-march=${PHOTORQUE_ARCH}")
  check_cxx_source_compiles("#ifndef __AVX512F__\n#error\n#endif\nint main() {}" ${has_avx512})
  unset(CMAKE_REQUIRED_FLAGS)
  if(${has_avx512} AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # GCC 12 reports this inside its own intrinsics.
    add_compile_options(-Wno-uninitialized)
  endif()
endif()
# errno and signalling NaN are not used; both would prevent vectorisation without changing a result.
add_compile_options(-fno-math-errno -fno-trapping-math)

# Multiply-add with one rounding: faster, and never less accurate. With "off" no result depends on the compiler's
# inlining, so that two versions of the program can be compared byte by byte.
set(PHOTORQUE_FP_CONTRACT "fast" CACHE STRING "-ffp-contract: fast, off")
add_compile_options(-ffp-contract=${PHOTORQUE_FP_CONTRACT})

option(PHOTORQUE_SANITIZE_THREADS "ThreadSanitizer (not together with the two others)" OFF)
if(PHOTORQUE_SANITIZE_THREADS)
  add_compile_options(-fsanitize=thread -fno-omit-frame-pointer)
  add_link_options(-fsanitize=thread)
endif()
if(PHOTORQUE_SANITIZE OR PHOTORQUE_SANITIZE_THREADS)
  add_compile_options(-g1)  # line numbers for reports; variables would take a third of the build time
endif()
if(PHOTORQUE_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined
                      -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()

# For many executions of fuzz targets: as fast as a release, but the program ends at undefined behaviour and at an
# index beyond a container of the standard library or of Eigen. (Clang; memory errors are not detected.)
option(PHOTORQUE_TRAP "Undefined behaviour and indices beyond containers end the program at once" OFF)
if(PHOTORQUE_TRAP)
  add_compile_options(-O2 -fsanitize=undefined -fno-sanitize=vptr,function -fsanitize-trap=undefined)
  add_compile_definitions(_GLIBCXX_ASSERTIONS)
endif()
# Counts executed lines (read by Clang's llvm-cov).
option(PHOTORQUE_COVERAGE "Count the lines that are run" OFF)
if(PHOTORQUE_COVERAGE)
  add_compile_options(-fprofile-instr-generate -fcoverage-mapping)
  add_link_options(-fprofile-instr-generate)
endif()

# Protections against exploits of errors in a reader, for distributed builds (preset "package").
option(PHOTORQUE_HARDEN "Checks of stack, buffers and jumps, and nothing writable that need not be" OFF)
if(PHOTORQUE_HARDEN)
  include(CheckPIESupported)
  check_pie_supported(LANGUAGES CXX)
  add_compile_options(-fstack-protector-strong)
  include(CheckCXXCompilerFlag)
  foreach(flag IN ITEMS -fstack-clash-protection -fcf-protection)
    string(MAKE_C_IDENTIFIER "PHOTORQUE_KNOWS${flag}" known)
    check_cxx_compiler_flag(${flag} ${known})
    if(${known})
      add_compile_options(${flag})
    endif()
  endforeach()
  # Only with optimisation; the last definition overrides a compiler's default.
  add_compile_options($<$<CONFIG:Release>:-U_FORTIFY_SOURCE> $<$<CONFIG:Release>:-D_FORTIFY_SOURCE=2>)
  add_link_options(-Wl,-z,relro,-z,now,-z,noexecstack)
endif()

find_program(PHOTORQUE_CCACHE ccache)
if(PHOTORQUE_CCACHE)
  # Paths are hashed relative to the clone, so that a second clone reuses results of the first. The compiler reports
  # the dependencies of a file, so that a first build does not preprocess files twice.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=true CCACHE_DEPEND=true CCACHE_MAXSIZE=20G
      ${PHOTORQUE_CCACHE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-fpch-preprocess)
  else()
    add_compile_options("SHELL:-Xclang -fno-pch-timestamp")  # otherwise every precompiled header has different content
  endif()
endif()
find_program(PHOTORQUE_MOLD mold)
if(PHOTORQUE_MOLD)
  add_link_options(-fuse-ld=mold)
endif()
