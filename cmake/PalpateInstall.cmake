# What `cmake --install` puts beside programs, data and headers, and what CPack makes of it: three
# Debian packages, palpate (component "programs"), palpate-dev ("dev") and python3-palpate ("python").
include(CMakePackageConfigHelpers)

install(DIRECTORY idl/ DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate/idl COMPONENT dev
        FILES_MATCHING PATTERN *.idl PATTERN README.md)

install(DIRECTORY examples DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate COMPONENT dev)

# The pages. Scenes and examples refer to ../docs beside them, pages to ../examples.
set(page_folder ${CMAKE_INSTALL_DATADIR}/doc/palpate)
install(FILES README.md CHANGELOG.md CITATION.cff DESTINATION ${page_folder} COMPONENT programs)
install(DIRECTORY docs DESTINATION ${page_folder} COMPONENT programs)
function(install_link target name component)
  get_filename_component(folder ${name} DIRECTORY)
  set(share "\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}")
  install(CODE "file(MAKE_DIRECTORY \"${share}/${folder}\")
    file(CREATE_LINK ${target} \"${share}/${name}\" SYMBOLIC)" COMPONENT ${component})
endfunction()
install_link(../doc/palpate/docs palpate/docs programs)
install_link(../../palpate/examples doc/palpate/examples dev)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)
configure_package_config_file(cmake/palpate-config.cmake.in
  ${PROJECT_BINARY_DIR}/palpate-config.cmake INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpate-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/palpate-config.cmake
              ${PROJECT_BINARY_DIR}/palpate-config-version.cmake
        DESTINATION ${package_folder} COMPONENT dev)
install(EXPORT palpate-bus NAMESPACE palpate:: DESTINATION ${package_folder} COMPONENT dev)

set(CPACK_PACKAGE_CONTACT "Palpate maintainers <maintainers@palpate.example>")

# Debian wants licence, changes and reasons for what lintian is told to overlook with each package.
foreach(component IN ITEMS programs dev python)
  string(REPLACE "programs" "palpate" package ${component})
  string(REPLACE "dev" "palpate-dev" package ${package})
  string(REPLACE "python" "python3-palpate" package ${package})
  set(made ${PROJECT_BINARY_DIR}/packaging/${package})
  configure_file(packaging/debian/changelog.in ${made}/changelog @ONLY)
  execute_process(COMMAND gzip -9nf ${made}/changelog COMMAND_ERROR_IS_FATAL ANY)
  install(FILES ${made}/changelog.gz packaging/debian/copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} COMPONENT ${component})
endforeach()
install(FILES packaging/systemd/palpate@.service DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate/systemd
        COMPONENT programs)
install(FILES packaging/debian/lintian-overrides DESTINATION share/lintian/overrides
        RENAME palpate COMPONENT programs)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME palpate)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL programs dev python)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION
"A hand, a recording or a robot moves a probe; the organ gives way, keeps its
volume and pushes back, a thousand times a second. One process per job, over
Fast DDS: deformation, contact search, haptics, pictures, recordings. Also
measures its own speed, accuracy and stability.")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME palpate)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "python3:any")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS
    "gmsh, python3-matplotlib, python3-numpy, xvfb, libgl1-mesa-dri, fonts-dejavu-core")
set(CPACK_COMPONENT_DEV_DESCRIPTION
"For device drivers and other programs in a session.
Headers, static libraries and a CMake package (palpate::bus) to write and read
the topics of a session, and the message types as IDL for any other DDS.")
set(CPACK_DEBIAN_DEV_PACKAGE_NAME palpate-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libfastrtps-dev, libeigen3-dev")
set(CPACK_COMPONENT_PYTHON_DESCRIPTION
"From Python: sessions, scenes, recordings and meshes as NumPy arrays.
Runs a session in the interpreter's own process, as fast as the machine allows,
or joins one of other processes.")
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-palpate)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.11), python3 (<< 3.12), python3-numpy, palpate (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PYTHON_PACKAGE_RECOMMENDS "python3-matplotlib, python3-pandas, python3-scipy")
include(CPack)
