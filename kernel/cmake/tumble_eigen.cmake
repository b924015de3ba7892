# tumble_eigen_directories(<variable> [<missing>]): the directories to search for Eigen's headers, all that the kernel needs
# besides itself. Where there are none, an error, or with <missing> its text in that variable. The first of these that there is: TUMBLE_EIGEN_DIR, a directory that holds Eigen/Core; the target Eigen3::Eigen
# of the project; the package Eigen3; the usual places. Headers serve every core, so the last looks outside
# CMAKE_FIND_ROOT_PATH too.
function(tumble_eigen_directories result)
    set(${result} "" PARENT_SCOPE)
    set(missing ${ARGV1})
    if(missing)
        set(${missing} "" PARENT_SCOPE)
    endif()
    if(NOT TUMBLE_EIGEN_DIR)
        if(NOT TARGET Eigen3::Eigen)
            find_package(Eigen3 QUIET NO_MODULE)
        endif()
        if(TARGET Eigen3::Eigen)
            get_target_property(directories Eigen3::Eigen INTERFACE_INCLUDE_DIRECTORIES)
            set(${result} ${directories} PARENT_SCOPE)
            return()
        endif()
        find_path(TUMBLE_EIGEN_DIR Eigen/Core PATHS /usr/include /usr/local/include /opt/homebrew/include
            PATH_SUFFIXES eigen3 NO_CMAKE_FIND_ROOT_PATH DOC "Directory that holds Eigen/Core")
    endif()
    if(NOT EXISTS "${TUMBLE_EIGEN_DIR}/Eigen/Core")
        string(CONCAT text "tumble needs Eigen's headers; no Eigen/Core in TUMBLE_EIGEN_DIR, which is "
            "'${TUMBLE_EIGEN_DIR}'. Install Eigen 3.4 (Debian: apt install libeigen3-dev) or name the directory that holds "
            "Eigen/Core: -DTUMBLE_EIGEN_DIR=/usr/include/eigen3")
        if(missing)
            set(${missing} "${text}" PARENT_SCOPE)
            return()
        endif()
        message(FATAL_ERROR "${text}")
    endif()
    set(${result} ${TUMBLE_EIGEN_DIR} PARENT_SCOPE)
endfunction()
