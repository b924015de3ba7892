# Runs firmware and compares: cmake -DRUN= -DCORE= -DELF= -DSTATUS= -DOUTPUT= -DTIMEOUT= -P expect.cmake
# STATUS is a number or several, as 132|134; OUTPUT is a regular expression, or empty.
execute_process(COMMAND ${RUN} --timeout ${TIMEOUT} ${CORE} ${ELF}
    RESULT_VARIABLE status OUTPUT_VARIABLE text ERROR_VARIABLE messages)
message("${text}${messages}")
if(NOT status MATCHES "^(${STATUS})$")
    message(FATAL_ERROR "exit status: got ${status}, expected ${STATUS}")
endif()
if(NOT OUTPUT STREQUAL "" AND NOT text MATCHES "${OUTPUT}")
    message(FATAL_ERROR "the text does not match: ${OUTPUT}")
endif()
