# SPDX-License-Identifier: GPL-3.0-or-later
#
# The page of report.html: npm fetches ECharts and esbuild into the build folder, esbuild bundles
# what the page uses, embed.cmake turns the whole page into one C++ source.
# Gives the target glint_report_page (studies/report/report_page.h). Nothing is written into the
# source tree, and nothing runs again unless a file here changed.

find_program(GLINT_NODE NAMES node nodejs)
find_program(GLINT_NPM npm)
if(NOT GLINT_NODE OR NOT GLINT_NPM)
  message(
    FATAL_ERROR
      "The page of report.html is bundled with node and npm, and at least one of them is missing "
      "(node: ${GLINT_NODE}, npm: ${GLINT_NPM}). script/bootstrap installs both; "
      "on Debian by hand: sudo apt-get install nodejs npm. Node 18 or newer is needed.")
endif()

set(web_source ${CMAKE_CURRENT_LIST_DIR})
set(web_build ${CMAKE_CURRENT_BINARY_DIR}/web)
set(web_scripts analysis.js app.js calibration.js cards.js charts.js comparison.js coverage.js curves.js dom.js filter.js format.js front.js front_words.js frontier.js inspection.js inspector.js overlay.js panels.js
    parallel.js population.js scene.js searches.js selection.js stability.js table.js validation.js verdict.js views.js)
list(TRANSFORM web_scripts PREPEND ${web_source}/)
file(MAKE_DIRECTORY ${web_build})

add_custom_command(
  OUTPUT ${web_build}/packages.stamp
  COMMAND ${CMAKE_COMMAND} -DNPM=${GLINT_NPM} -DSOURCE=${web_source} -DBUILD=${web_build} -P
          ${web_source}/packages.cmake
  DEPENDS ${web_source}/package.json ${web_source}/package-lock.json ${web_source}/.npmrc
          ${web_source}/packages.cmake
  COMMENT "Fetching ECharts and esbuild with npm"
  VERBATIM)

# NODE_PATH lets the sources stay where they are while the packages lie in the build folder.
add_custom_command(
  OUTPUT ${web_build}/bundle.js
  COMMAND
    ${CMAKE_COMMAND} -E env NODE_PATH=${web_build}/node_modules
    ${web_build}/node_modules/.bin/esbuild ${web_source}/app.js --bundle --minify
    --format=iife --target=es2020 --charset=ascii --legal-comments=inline --log-level=warning
    --outfile=${web_build}/bundle.js
  DEPENDS ${web_scripts} ${web_build}/packages.stamp
  COMMENT "Bundling the report page"
  VERBATIM)

add_custom_command(
  OUTPUT ${web_build}/report_page.cpp
  COMMAND ${CMAKE_COMMAND} -DSOURCE=${web_source} -DBUILD=${web_build} -P ${web_source}/embed.cmake
  DEPENDS ${web_build}/bundle.js ${web_source}/page.html ${web_source}/style.css
          ${web_source}/embed.cmake
  COMMENT "Embedding the report page"
  VERBATIM)

add_library(glint_report_page STATIC ${web_build}/report_page.cpp)
target_include_directories(glint_report_page PUBLIC ${PROJECT_SOURCE_DIR})
target_compile_features(glint_report_page PUBLIC cxx_std_20)
