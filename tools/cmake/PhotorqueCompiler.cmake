# Selects the compiler, unless CXX or CMAKE_CXX_COMPILER is set: Clang of Debian's security archive if it is
# installed, which needs two thirds of g++'s build time, otherwise the default. Included before project().
if(NOT CMAKE_CXX_COMPILER AND NOT DEFINED ENV{CXX})
  find_program(PHOTORQUE_CLANG clang++-22)
  if(PHOTORQUE_CLANG)
    set(CMAKE_CXX_COMPILER ${PHOTORQUE_CLANG})
  endif()
endif()
