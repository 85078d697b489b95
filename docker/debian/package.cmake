# The Debian package: `cpack -G DEB` in a build folder.
install(FILES "${CMAKE_CURRENT_LIST_DIR}/leafcutter.service" DESTINATION /lib/systemd/system)
install(FILES "${CMAKE_CURRENT_LIST_DIR}/70-leafcutter.rules" DESTINATION /lib/udev/rules.d)
install(FILES "${CMAKE_CURRENT_LIST_DIR}/leafcutter.toml" DESTINATION /etc/leafcutter)
install(FILES "${PROJECT_SOURCE_DIR}/README.md" "${PROJECT_SOURCE_DIR}/CHANGELOG.md"
    "${PROJECT_SOURCE_DIR}/server/operations.md" DESTINATION share/doc/leafcutter)
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION share/doc/leafcutter RENAME copyright)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME leafcutter)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Woven surfaces from a laser cutter: daemon, dashboard, command line")
set(CPACK_PACKAGE_CONTACT "Leafcutter <leafcutter@localhost>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_DEPENDS adduser)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
file(WRITE "${PROJECT_BINARY_DIR}/debian/conffiles" "/etc/leafcutter/leafcutter.toml\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA
    "${CMAKE_CURRENT_LIST_DIR}/postinst"
    "${CMAKE_CURRENT_LIST_DIR}/prerm"
    "${CMAKE_CURRENT_LIST_DIR}/postrm"
    "${PROJECT_BINARY_DIR}/debian/conffiles")
include(CPack)
