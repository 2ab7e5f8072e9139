cmake_minimum_required(VERSION 3.24)
# Writes core/build_info.h at every build; touches it only when it changes.
find_program(GIT git)
set(hash "unknown")
if(GIT)
  execute_process(COMMAND ${GIT} rev-parse --short=12 HEAD WORKING_DIRECTORY ${SOURCE_DIR}
                  OUTPUT_VARIABLE hash OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE bad)
  if(bad)
    set(hash "unknown")
  else()
    execute_process(COMMAND ${GIT} status --porcelain --untracked-files=no
                    WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE changes ERROR_QUIET)
    if(NOT changes STREQUAL "")
      string(APPEND hash "+")
    endif()
  endif()
endif()
# For builds without a repository, and for builds whose outputs are compared byte by byte.
if(DEFINED ENV{PHOTORQUE_GIT_HASH})
  set(hash "$ENV{PHOTORQUE_GIT_HASH}")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT
"#pragma once
namespace photorque {
inline constexpr const char* build_version = \"@VERSION@\";
inline constexpr const char* build_git_hash = \"@hash@\";
}  // namespace photorque
" @ONLY)
