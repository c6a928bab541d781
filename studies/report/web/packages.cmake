# SPDX-License-Identifier: GPL-3.0-or-later
# Called at build time with NPM, SOURCE, BUILD: packages of package-lock.json into BUILD.
file(REMOVE ${BUILD}/packages.stamp)
file(COPY ${SOURCE}/package.json ${SOURCE}/package-lock.json ${SOURCE}/.npmrc DESTINATION ${BUILD})

# `npm ci` takes exactly the locked packages; `npm install` is the second try, with the same lock.
foreach(verb ci install)
  execute_process(
    COMMAND ${NPM} ${verb} --prefer-offline --no-audit --no-fund --include=dev --loglevel=error
    WORKING_DIRECTORY ${BUILD}
    RESULT_VARIABLE failed
    OUTPUT_VARIABLE output
    ERROR_VARIABLE output)
  if(NOT failed)
    break()
  endif()
endforeach()
if(failed)
  message("${output}")
  message(
    FATAL_ERROR
      "npm could not fetch the packages of studies/report/web/package.json (echarts, esbuild). "
      "This step needs the network once; afterwards the build folder is enough.")
endif()
file(TOUCH ${BUILD}/packages.stamp)
