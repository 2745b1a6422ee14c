# Data the programs read at run time. A program looks in ../share/palpate of its own folder
# (modules/core/data_folder.h): the build tree holds links there, an installed one copies.

# palpate_data(NAME FOLDER PATTERN …): what programs find as NAME; files of these patterns are installed
function(palpate_data name folder)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/share/palpate)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${folder} ${PROJECT_BINARY_DIR}/share/palpate/${name} SYMBOLIC)
  list(TRANSFORM ARGN PREPEND "PATTERN;" OUTPUT_VARIABLE patterns)
  install(DIRECTORY ${folder}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate/${name} USE_SOURCE_PERMISSIONS
          COMPONENT programs FILES_MATCHING ${patterns})
endfunction()
