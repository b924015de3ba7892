# tumble_eigen_directories(<variable> [<missing>]): the directories of Eigen's headers, which are all that the kernel
# needs besides itself. They are the first that exists of: TUMBLE_EIGEN_DIR, the directory that holds Eigen/Core; the
# project's target Eigen3::Eigen; the package Eigen3; the usual directories. Headers serve every core, so the last
# search looks outside CMAKE_FIND_ROOT_PATH too. If none exists, it is an error, or with <missing> that variable gets
# the text of the error.
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
