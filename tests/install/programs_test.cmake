# Oracle: the command line promised by docs/deployment.md. Every program of BIN answers --version with
# project version and protocol, and --help with something; both are no error.
# cmake -DBIN=… -DVERSION=… -P programs_test.cmake
file(GLOB programs ${BIN}/palpate*)
list(LENGTH programs count)
if(count LESS 10)
  message(SEND_ERROR "only ${count} programs in ${BIN}")
endif()
foreach(program IN LISTS programs)
  foreach(word IN ITEMS --version --help)
    execute_process(COMMAND ${program} ${word} TIMEOUT 10
                    OUTPUT_VARIABLE text ERROR_VARIABLE errors RESULT_VARIABLE code)
    if(NOT code EQUAL 0 OR text STREQUAL "" OR NOT errors STREQUAL "")
      message(SEND_ERROR "${program} ${word}: exit code ${code}, says '${text}${errors}'")
    elseif(word STREQUAL "--version" AND NOT text MATCHES "^palpate ${VERSION}, protocol [0-9]+\n$")
      message(SEND_ERROR "${program} --version says '${text}'")
    endif()
  endforeach()
endforeach()
