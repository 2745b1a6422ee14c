# Every source file is formatted as .clang-format says.
file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR}
     ${SOURCE_DIR}/modules/*.h ${SOURCE_DIR}/modules/*.cpp ${SOURCE_DIR}/deformation/*.h
     ${SOURCE_DIR}/deformation/*.cpp ${SOURCE_DIR}/collision/*.h ${SOURCE_DIR}/collision/*.cpp
     ${SOURCE_DIR}/haptics/*.h ${SOURCE_DIR}/haptics/*.cpp ${SOURCE_DIR}/visualizer/*.h
     ${SOURCE_DIR}/visualizer/*.cpp ${SOURCE_DIR}/tests/*.h ${SOURCE_DIR}/tests/*.cpp
     ${SOURCE_DIR}/bench/*.cpp ${SOURCE_DIR}/bench/*.h ${SOURCE_DIR}/scenes/*.cpp)
execute_process(COMMAND ${CLANG_FORMAT} --dry-run --Werror ${files}
                WORKING_DIRECTORY ${SOURCE_DIR} RESULT_VARIABLE result)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "run: clang-format -i on the files named above")
endif()
