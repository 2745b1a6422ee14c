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
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      ${PALPATE_CCACHE})
endif()

set(PALPATE_SANITIZE "" CACHE STRING "Sanitizers: address,undefined or thread")
if(PALPATE_SANITIZE)
  add_compile_options(-fsanitize=${PALPATE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${PALPATE_SANITIZE})
endif()

# Contraction off: the same bits whatever instruction set the optimizer picks. Where the spring kernel
# fuses multiply and add, it says so (docs/decisions/0005).
set(CMAKE_UNITY_BUILD_BATCH_SIZE 16)  # cmake/README.md
add_library(palpate_warnings INTERFACE)
target_compile_options(palpate_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wcast-align -Woverloaded-virtual -Werror
  -ffp-contract=off
  # Nobody reads errno: a root is an instruction, and no call.
  -fno-math-errno
  # Half a gigabyte before the compiler collects its garbage: a tenth of its time otherwise.
  --param=ggc-min-heapsize=524288
  # GCC 12 (bug 105651) takes short strings inlined from precompiled headers for overruns.
  -Wno-array-bounds -Wno-restrict -Wno-stringop-overread -Wno-stringop-overflow)
# What may become part of a shared object, Python's module. Hidden symbols: calls and variables of our
# own stay as direct as in a program.
add_library(palpate_shareable INTERFACE)
target_compile_options(palpate_shareable INTERFACE -fPIC -fvisibility=hidden -fvisibility-inlines-hidden)
# Sources compiled together look like headers with types of their own.
target_compile_options(palpate_warnings INTERFACE
  $<$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>:-Wno-subobject-linkage>)
if(PALPATE_SANITIZE)  # GCC 12 takes the sanitizers' code around <regex> for uninitialised variables
  target_compile_options(palpate_warnings INTERFACE -Wno-maybe-uninitialized)
endif()

# Eigen, Catch2 and the standard library cost a file two seconds: they are compiled once.
function(palpate_precompile target kind)
  if(PALPATE_SANITIZE)
    return()
  endif()
  if(NOT TARGET palpate_precompiled_${kind})
    set(source ${PROJECT_BINARY_DIR}/precompiled_${kind}.cpp)
    if(NOT EXISTS ${source})
      file(WRITE ${source} "")
    endif()
    add_library(palpate_precompiled_${kind} OBJECT ${source})
    set_target_properties(palpate_precompiled_${kind} PROPERTIES UNITY_BUILD OFF)
    target_link_libraries(palpate_precompiled_${kind} PRIVATE palpate_warnings Eigen3::Eigen)
    if(kind STREQUAL "core")
      target_link_libraries(palpate_precompiled_core PRIVATE palpate_shareable)
    endif()
    set(headers <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <filesystem> <functional> <map>
                <memory> <optional> <span> <sstream> <string> <variant> <vector>)
    if(kind STREQUAL "tests")
      target_compile_options(palpate_precompiled_tests PRIVATE $<$<CONFIG:Release>:-O1>)
      target_link_libraries(palpate_precompiled_tests PRIVATE Catch2::Catch2)
      list(APPEND headers <catch2/catch.hpp>)
    endif()
    target_precompile_headers(palpate_precompiled_${kind} PRIVATE ${headers})
    target_compile_options(palpate_precompiled_${kind} PRIVATE -fpch-preprocess)
  endif()
  target_precompile_headers(${target} REUSE_FROM palpate_precompiled_${kind})
  target_compile_options(${target} PRIVATE -fpch-preprocess)  # lets ccache look through them
endfunction()

# Sources of this folder (with RECURSE: and of those below it) except what EXCEPT names. A new file
# belongs to its folder's target: no list to keep.
function(palpate_sources result recurse)
  if(recurse)
    file(GLOB_RECURSE found RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp)
  else()
    file(GLOB found RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp)
  endif()
  foreach(pattern IN LISTS ARGN)
    list(FILTER found EXCLUDE REGEX "^${pattern}$")
  endforeach()
  set(${result} ${found} PARENT_SCOPE)
endfunction()

# palpate_library(NAME [RECURSE] [INSTALLED] [EXCEPT pattern …] [DEPENDS …] [PRIVATE_DEPENDS …])
# All sources of the folder but main.cpp. INSTALLED: part of the package for other projects.
function(palpate_library name)
  cmake_parse_arguments(ARG "RECURSE;INSTALLED" "" "SOURCES;EXCEPT;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  if(NOT ARG_SOURCES)
    palpate_sources(ARG_SOURCES ${ARG_RECURSE} main.cpp ${ARG_EXCEPT})
  endif()
  add_library(palpate_${name} STATIC ${ARG_SOURCES})
  add_library(palpate::${name} ALIAS palpate_${name})
  target_include_directories(palpate_${name} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
  target_link_libraries(palpate_${name} PUBLIC ${ARG_DEPENDS}
                        PRIVATE ${ARG_PRIVATE_DEPENDS} $<BUILD_INTERFACE:palpate_warnings>
                                $<BUILD_INTERFACE:palpate_shareable>)
  palpate_precompile(palpate_${name} core)
  if(ARG_INSTALLED)
    palpate_install_library(${name})
  endif()
endfunction()

# Library and headers go to the prefix; find_package(palpate COMPONENTS bus) finds them there.
function(palpate_install_library name)
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set_target_properties(palpate_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(palpate_${name} PUBLIC cxx_std_20)
  install(TARGETS palpate_${name} EXPORT palpate-bus
          ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/palpate)
  install(DIRECTORY ./ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/palpate/${folder} COMPONENT dev
          FILES_MATCHING PATTERN *.h)
endfunction()

# palpate_program(FILE_NAME [NOT_INSTALLED] SOURCES … DEPENDS …): an executable in build/…/bin and,
# installed, in bin
function(palpate_program name)
  cmake_parse_arguments(ARG "NOT_INSTALLED" "" "SOURCES;DEPENDS" ${ARGN})
  string(REPLACE "-" "_" target ${name})
  add_executable(${target}_program ${ARG_SOURCES})
  set_target_properties(${target}_program PROPERTIES OUTPUT_NAME ${name})
  target_link_libraries(${target}_program PRIVATE ${ARG_DEPENDS} palpate_warnings palpate_shareable)
  palpate_precompile(${target}_program core)
  if(NOT ARG_NOT_INSTALLED)
    install(TARGETS ${target}_program RUNTIME COMPONENT programs)
  endif()
endfunction()

# What a test has that starts real processes, mostly to wait for them: begun first, one at a time, beside
# others that compute. One that computes most of its time itself is begun first, too, but does not queue.
set(PALPATE_PROCESSES COST 100 RESOURCE_LOCK palpate_session)
set(PALPATE_LONG COST 100)

# palpate_tests(NAME [RECURSE] [SOURCES … | EXCEPT pattern …] DEPENDS … [LABELS …, else unit] [TIMEOUT seconds]
#               [PROCESSES [HOSTS]] [ALONE regex] [REAL_TIME regex] [DRAWS])
# One Catch2 program, each case one ctest test. PROCESSES: its cases start real processes, mostly to wait
# for them; one such case runs at a time, and one with HOSTS of its own, beside others that compute. ALONE:
# names of cases that judge times; nothing runs beside them. REAL_TIME: those whose processes must keep up with
# real time; sanitizers are too slow for it, ctest lists them as disabled. DRAWS: with OpenGL.
function(palpate_tests name)
  cmake_parse_arguments(ARG "RECURSE;PROCESSES;HOSTS;DRAWS" "TIMEOUT;ALONE;REAL_TIME" "SOURCES;EXCEPT;DEPENDS;LABELS" ${ARGN})
  if(NOT ARG_SOURCES)
    palpate_sources(ARG_SOURCES ${ARG_RECURSE} ${ARG_EXCEPT})
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(PALPATE_SANITIZE)  # some thirty times as slow
    math(EXPR ARG_TIMEOUT "20 * ${ARG_TIMEOUT}")
  endif()
  add_executable(${name}_tests ${ARG_SOURCES})
  # A test's own code is compiled often and run once; what it judges keeps the preset's optimization.
  target_compile_options(${name}_tests PRIVATE $<$<CONFIG:Release>:-O1>)
  target_link_libraries(${name}_tests PRIVATE ${ARG_DEPENDS} Catch2::Catch2WithMain palpate_warnings)
  palpate_precompile(${name}_tests tests)
  target_compile_definitions(${name}_tests PRIVATE
    PALPATE_SOURCE_DIR="${PROJECT_SOURCE_DIR}" PALPATE_BIN_DIR="${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  if(NOT ARG_LABELS)
    set(ARG_LABELS unit)
  endif()
  # A test without its data says "SKIPPED: …" and returns; ctest then counts it as skipped, not passed.
  set(properties TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}" SKIP_REGULAR_EXPRESSION "SKIPPED:")
  if(PALPATE_SANITIZE STREQUAL "thread")
    # Inside Fast DDS 2.9.1, TSan misses the clocked locks and then reports their unlocking and order;
    # what libraries built without TSan do is left out, their locks still count for our code.
    list(APPEND properties ENVIRONMENT "TSAN_OPTIONS=ignore_noninstrumented_modules=1")
  elseif(PALPATE_SANITIZE)  # Fast DDS 2.9.1 frees a reader's statistics by their base's size
    set(options "new_delete_type_mismatch=0")
    if(ARG_DRAWS)  # the drivers of OpenGL keep some hundred bytes
      string(APPEND options ":detect_leaks=0")
    endif()
    list(APPEND properties ENVIRONMENT "ASAN_OPTIONS=${options}")
  endif()
  if(ARG_PROCESSES)
    list(APPEND properties ${PALPATE_PROCESSES})
    if(ARG_HOSTS)
      list(TRANSFORM properties REPLACE "^palpate_session$" palpate_hosts)
    endif()
  endif()
  # NoTests: a name that ctest cannot hand over (it splits at ';') fails instead of matching nothing.
  catch_discover_tests(${name}_tests TEST_PREFIX "${name}: " EXTRA_ARGS -w NoTests PROPERTIES ${properties})
  if(ARG_ALONE)
    palpate_set_of_cases(${name} alone "${ARG_ALONE}" "RUN_SERIAL TRUE")
  endif()
  if(ARG_REAL_TIME AND PALPATE_SANITIZE)
    palpate_set_of_cases(${name} real_time "${ARG_REAL_TIME}" "DISABLED TRUE")
  endif()
endfunction()

# Properties of those cases of a test program whose names match; they are known when ctest starts.
function(palpate_set_of_cases name kind regex properties)
  set(script ${CMAKE_CURRENT_BINARY_DIR}/${name}_${kind}.cmake)
  file(WRITE ${script} "foreach(test IN LISTS ${name}_tests_TESTS)
  if(test MATCHES \"${regex}\")
    set_tests_properties(\"\${test}\" PROPERTIES ${properties})
  endif()
endforeach()
")
  set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${script})
endfunction()
