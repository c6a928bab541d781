# SPDX-License-Identifier: GPL-3.0-or-later
#
# What `cmake --install` puts beside the program, and the Debian package that `cpack -G DEB` makes of
# all of it. Man pages, completions and the schema are what the program itself prints.
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR})

install(
  CODE "
set(glint \"$<TARGET_FILE:glint>\")
set(share \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}\")
# What a distribution packs has another folder for zsh than what its administrator installs.
set(zsh site-functions)
if(CMAKE_INSTALL_PREFIX MATCHES \"/usr$\")
  set(zsh vendor-completions)
endif()
function(glint_writes file)
  message(STATUS \"Installing: \${share}/\${file}\")
  get_filename_component(folder \"\${share}/\${file}\" DIRECTORY)
  file(MAKE_DIRECTORY \"\${folder}\")
  execute_process(
    COMMAND \"\${glint}\" \${ARGN} OUTPUT_FILE \"\${share}/\${file}\" COMMAND_ERROR_IS_FATAL ANY)
endfunction()
glint_writes(man/man1/glint.1 help --man)
foreach(verb run check render frontier stability imprint inspect calibrate undistort compare validate cover cell plan acquire part new report explain help)
  glint_writes(man/man1/glint-\${verb}.1 help --man \${verb})
endforeach()
glint_writes(bash-completion/completions/glint help --completion bash)
glint_writes(zsh/\${zsh}/_glint help --completion zsh)
glint_writes(fish/vendor_completions.d/glint.fish help --completion fish)
glint_writes(glint/study.schema.json explain --schema)
")

set(CPACK_PACKAGE_NAME glint)
set(CPACK_PACKAGE_VENDOR "The Glint authors")
set(CPACK_PACKAGE_CONTACT "The Glint authors <glint@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "finds the lighting under which surface defects show")
set(CPACK_PACKAGE_DESCRIPTION
    "Glint simulates the inspection of shiny parts: a study file describes part, camera, light and
defects, and a search finds the lighting under which the defects show. It writes simulated pictures,
scores and a report.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_GENERATOR DEB)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(BUILD_SHARED_LIBS)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR})
endif()
include(CPack)
