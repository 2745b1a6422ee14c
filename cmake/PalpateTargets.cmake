# Compiler settings of our own code, and the three kinds of target the project is made of.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(PALPATE_CCACHE ccache)
if(PALPATE_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${PALPATE_CCACHE})
endif()

option(PALPATE_SANITIZE "AddressSanitizer and UndefinedBehaviorSanitizer" OFF)
if(PALPATE_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
endif()

# Contraction off: the same bits whatever instruction set the optimizer picks. Where the spring kernel
# fuses multiply and add, it says so (docs/decisions/0005).
add_library(palpate_warnings INTERFACE)
target_compile_options(palpate_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wcast-align -Woverloaded-virtual -Werror
  -ffp-contract=off)
if(PALPATE_SANITIZE)  # GCC 12 takes the sanitizers' code around <regex> for uninitialised variables
  target_compile_options(palpate_warnings INTERFACE -Wno-maybe-uninitialized)
endif()

# palpate_library(NAME SOURCES … [DEPENDS …] [PRIVATE_DEPENDS …])
function(palpate_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(palpate_${name} STATIC ${ARG_SOURCES})
  add_library(palpate::${name} ALIAS palpate_${name})
  target_include_directories(palpate_${name} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(palpate_${name} PUBLIC ${ARG_DEPENDS}
                        PRIVATE ${ARG_PRIVATE_DEPENDS} palpate_warnings)
endfunction()

# palpate_program(FILE_NAME SOURCES … DEPENDS …): an executable in build/…/bin
function(palpate_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;DEPENDS" ${ARGN})
  string(REPLACE "-" "_" target ${name})
  add_executable(${target}_program ${ARG_SOURCES})
  set_target_properties(${target}_program PROPERTIES OUTPUT_NAME ${name})
  target_link_libraries(${target}_program PRIVATE ${ARG_DEPENDS} palpate_warnings)
endfunction()

# palpate_tests(NAME SOURCES … DEPENDS … [LABELS …, else unit] [TIMEOUT seconds] [SERIAL] [DRAWS])
# One Catch2 program, each case one ctest test. SERIAL: cases that start real processes or load
# both cores do not run beside each other. DRAWS: with OpenGL.
function(palpate_tests name)
  cmake_parse_arguments(ARG "SERIAL;DRAWS" "TIMEOUT" "SOURCES;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(PALPATE_SANITIZE)  # some thirty times as slow
    math(EXPR ARG_TIMEOUT "5 * ${ARG_TIMEOUT}")
  endif()
  add_executable(${name}_tests ${ARG_SOURCES})
  target_link_libraries(${name}_tests PRIVATE ${ARG_DEPENDS} Catch2::Catch2WithMain palpate_warnings)
  target_compile_definitions(${name}_tests PRIVATE
    PALPATE_SOURCE_DIR="${PROJECT_SOURCE_DIR}" PALPATE_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  # A test without its data says "SKIPPED: …" and returns; ctest then counts it as skipped, not passed.
  set(properties TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}" SKIP_REGULAR_EXPRESSION "SKIPPED:")
  if(PALPATE_SANITIZE)  # Fast DDS 2.9.1 frees a reader's statistics by their base's size
    set(options "new_delete_type_mismatch=0")
    if(ARG_DRAWS)  # the drivers of OpenGL keep some hundred bytes
      string(APPEND options ":detect_leaks=0")
    endif()
    list(APPEND properties ENVIRONMENT "ASAN_OPTIONS=${options}")
  endif()
  if(ARG_SERIAL)
    list(APPEND properties RUN_SERIAL TRUE)
  endif()
  catch_discover_tests(${name}_tests TEST_PREFIX "${name}: " PROPERTIES ${properties})
endfunction()
