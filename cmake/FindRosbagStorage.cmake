# rosbag_storage as Debian packages it: target rosbag_storage::rosbag_storage. Its headers lie in a folder a package.
find_path(ROSBAG_INCLUDE_DIR rosbag/bag.h)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(RosbagStorage REQUIRED_VARS ROSBAG_INCLUDE_DIR)
if(RosbagStorage_FOUND AND NOT TARGET rosbag_storage::rosbag_storage)
  add_library(rosbag_storage::rosbag_storage INTERFACE IMPORTED)
  set(folders ${ROSBAG_INCLUDE_DIR})
  foreach(package pluginlib class_loader rcutils rcpputils ament_index_cpp)
    list(APPEND folders ${ROSBAG_INCLUDE_DIR}/${package})
  endforeach()
  target_include_directories(rosbag_storage::rosbag_storage SYSTEM INTERFACE ${folders})
  target_link_libraries(rosbag_storage::rosbag_storage INTERFACE rosbag_storage cpp_common rostime roscpp_serialization
                        console_bridge boost_system)
endif()
