# cmake -S . -B build -DCMAKE_PREFIX_PATH=FOLDER_OF_THE_ARCHIVE && cmake --build build
cmake_minimum_required(VERSION 3.16)
project(isophote_examples C)
set(CMAKE_C_STANDARD 11)

find_package(Isophote 0.1 REQUIRED)

# Linked to the library.
add_executable(linked linked.c)
target_link_libraries(linked PRIVATE Isophote::isophote)

# These load the library by its path, as engines do that can do without it.
if(UNIX)
    foreach(name stylize plan)
        add_executable(${name} ${name}.c)
        target_include_directories(${name} PRIVATE
            $<TARGET_PROPERTY:Isophote::isophote,INTERFACE_INCLUDE_DIRECTORIES>)
        target_link_libraries(${name} PRIVATE ${CMAKE_DL_LIBS})
    endforeach()
endif()
