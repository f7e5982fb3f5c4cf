# Debian packages of the components, by `cpack` in the build folder of the preset `package` (build.sh does it all). What the
# command needs is found by dpkg-shlibdeps; what programs need that link the libraries is listed here.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME groundloop)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
# Who publishes packages puts an address of theirs.
set(GROUNDLOOP_MAINTAINER "The groundloop authors <groundloop@example.org>" CACHE STRING "Maintainer of the packages")
set(CPACK_PACKAGE_CONTACT ${GROUNDLOOP_MAINTAINER})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_COMPONENTS_ALL command development)
set(packages "command;groundloop" "development;libgroundloop-dev")
if(GROUNDLOOP_PYTHON_MODULE)
  list(APPEND CPACK_COMPONENTS_ALL python)
  list(APPEND packages "python;python3-groundloop")
  find_package(Python REQUIRED COMPONENTS Interpreter)
endif()

set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME groundloop)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMMAND_DESCRIPTION "offline LiDAR SLAM for recorded sequences
groundloop reads a recording, estimates odometry, closes loops with
ground-aligned density images seen from above, optimises the pose graph, and
writes a globally consistent trajectory, map and report. It aligns several
recordings of one region, and needs neither ROS nor a GPU.")

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libgroundloop-dev)
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SECTION libdevel)
string(JOIN ", " CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
       libeigen3-dev libtbb-dev libspdlog-dev libyaml-cpp-dev nlohmann-json3-dev libsqlite3-dev libbz2-dev liblz4-dev
       libzstd-dev libxxhash-dev librosbag-storage-dev libopencv-dev libceres-dev libsuitesparse-dev
       "libopenblas-serial-dev | libopenblas-dev")
set(CPACK_DEBIAN_DEVELOPMENT_DESCRIPTION "offline LiDAR SLAM - libraries for other programs
groundloop reads recordings of LiDARs, estimates odometry, closes loops with
density images seen from above and optimises pose graphs.

This package has the static libraries and headers that
find_package(groundloop) gives as groundloop::frontend,
groundloop::loopclosure and groundloop::backend, and an example.")

# The module is of the interpreter that it was compiled for.
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-groundloop)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
math(EXPR next_python "${Python_VERSION_MINOR} + 1")
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
    "python3 (>= 3.${Python_VERSION_MINOR}), python3 (<< 3.${next_python}), python3-numpy")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "offline LiDAR SLAM - Python module
groundloop reads recordings of LiDARs, estimates odometry, closes loops with
density images seen from above and optimises pose graphs.

This package gives recordings, odometry, closures between two clouds, pose
graphs and sessions as numpy arrays.")

# What Debian wants in every package. Version, date and text of a release stand in apps/docs/changelog.md.
set(documents ${CMAKE_CURRENT_BINARY_DIR}/debian)
add_custom_command(
  OUTPUT ${documents}/changelog.gz ${documents}/copyright
  COMMAND sh ${CMAKE_CURRENT_SOURCE_DIR}/debian_documents.sh ${CMAKE_SOURCE_DIR} ${documents} ${PROJECT_VERSION}
          ${GROUNDLOOP_MAINTAINER}
  DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/debian_documents.sh ${CMAKE_SOURCE_DIR}/apps/docs/changelog.md ${CMAKE_SOURCE_DIR}/LICENSE
          ${CMAKE_SOURCE_DIR}/apps/report/page/licences.txt
  VERBATIM)
add_custom_target(groundloop_debian_documents ALL DEPENDS ${documents}/changelog.gz)
while(packages)
  list(POP_FRONT packages component package)
  install(FILES ${documents}/changelog.gz ${documents}/copyright
          DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${package} COMPONENT ${component})
endwhile()
include(CPack)
