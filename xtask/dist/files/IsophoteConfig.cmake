# Isophote as an imported target, from wherever the package was unpacked:
#
#     find_package(Isophote REQUIRED)
#     target_link_libraries(engine PRIVATE Isophote::isophote)
#
# Isophote_LIBRARY is the library's file, for programs that load it themselves.

get_filename_component(_isophote_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
set(Isophote_LIBRARY "${_isophote_prefix}/@LIBRARY@")
foreach(_isophote_file "${Isophote_LIBRARY}" "${_isophote_prefix}/include/isophote.h")
    if(NOT EXISTS "${_isophote_file}")
        set(Isophote_FOUND FALSE)
        set(Isophote_NOT_FOUND_MESSAGE "${_isophote_file} is missing: unpack the whole archive")
        return()
    endif()
endforeach()

if(NOT TARGET Isophote::isophote)
    add_library(Isophote::isophote SHARED IMPORTED)
    set_target_properties(Isophote::isophote PROPERTIES
        IMPORTED_LOCATION "${Isophote_LIBRARY}"
        INTERFACE_INCLUDE_DIRECTORIES "${_isophote_prefix}/include")
    if(WIN32)
        set_target_properties(Isophote::isophote PROPERTIES
            IMPORTED_IMPLIB "${_isophote_prefix}/lib/isophote.lib")
    elseif(APPLE)
        set_target_properties(Isophote::isophote PROPERTIES IMPORTED_SONAME "@rpath/@SONAME@")
    else()
        set_target_properties(Isophote::isophote PROPERTIES IMPORTED_SONAME "@SONAME@")
    endif()
endif()
