# Debian's module packages (libopencv-core-dev, ...) without the meta package, whose CMake files ask for all of OpenCV.
# Defines OpenCVModules::<module> for each component.
find_path(OpenCVModules_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
foreach(module IN LISTS OpenCVModules_FIND_COMPONENTS)
  find_library(OpenCVModules_${module}_LIBRARY opencv_${module})
  if(OpenCVModules_${module}_LIBRARY AND EXISTS "${OpenCVModules_INCLUDE_DIR}/opencv2/${module}.hpp")
    set(OpenCVModules_${module}_FOUND TRUE)
    if(NOT TARGET OpenCVModules::${module})
      add_library(OpenCVModules::${module} UNKNOWN IMPORTED)
      set_target_properties(OpenCVModules::${module} PROPERTIES
        IMPORTED_LOCATION "${OpenCVModules_${module}_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${OpenCVModules_INCLUDE_DIR}")
    endif()
  endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVModules REQUIRED_VARS OpenCVModules_INCLUDE_DIR HANDLE_COMPONENTS)
