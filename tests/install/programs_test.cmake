# Oracle: the command line promised by docs/deployment.md. Every program of BIN answers --version with
# project version and protocol, --help with its exit codes at the end, and so does every command of
# `palpate`; none is an error.
# cmake -DBIN=… -DVERSION=… -P programs_test.cmake
file(GLOB programs ${BIN}/palpate*)
list(LENGTH programs count)
if(count LESS 10)
  message(SEND_ERROR "only ${count} programs in ${BIN}")
endif()
execute_process(COMMAND ${BIN}/palpate completion "" OUTPUT_VARIABLE words)  # one a line
string(REGEX MATCHALL "[^\n]+" words "${words}")
list(REMOVE_ITEM words help)
list(LENGTH words count)
if(count LESS 15)
  message(SEND_ERROR "only ${count} commands of palpate: ${words}")
endif()
foreach(command IN LISTS words)
  list(APPEND programs "${BIN}/palpate ${command}")
endforeach()
foreach(program IN LISTS programs)
  separate_arguments(typed UNIX_COMMAND "${program}")
  foreach(word IN ITEMS --version --help)
    if("${program} ${word}" STREQUAL "${BIN}/palpate completion --version")
      continue()  # its words are a shell's
    endif()
    execute_process(COMMAND ${typed} ${word} TIMEOUT 10
                    OUTPUT_VARIABLE text ERROR_VARIABLE errors RESULT_VARIABLE code)
    if(NOT code EQUAL 0 OR text STREQUAL "" OR NOT errors STREQUAL "")
      message(SEND_ERROR "${program} ${word}: exit code ${code}, says '${text}${errors}'")
    elseif(word STREQUAL "--version" AND NOT text MATCHES "^palpate ${VERSION}, protocol [0-9]+\n$")
      message(SEND_ERROR "${program} --version says '${text}'")
    elseif(word STREQUAL "--help" AND NOT text MATCHES "\nExit code: 0 if [^\n]*, 1 if [^\n]*2 (for bad input|if )[^\n]*\n+$")
      message(SEND_ERROR "${program} --help does not end with its exit codes: '${text}'")
    endif()
  endforeach()
endforeach()
