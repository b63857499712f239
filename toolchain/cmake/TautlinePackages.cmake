# What is installed where, and the Debian packages of it (./run package): tautline-station, -tools, -sim and -plan. Included
# last: it asks which programs this build has. Destinations are below / because the services name absolute paths.
set(TAUTLINE_PACKAGING "${CMAKE_SOURCE_DIR}/toolchain/packaging")

# tautline_package(COMPONENT PROGRAMS targets… SUMMARY text [RECOMMENDS packages] [DEPENDS packages] [CROSS_DEPENDS …]):
# CROSS_DEPENDS is what dpkg-shlibdeps finds in a native build; it cannot look into a sysroot.
function(tautline_package component)
  cmake_parse_arguments(ARG "" "SUMMARY;RECOMMENDS;DEPENDS;CROSS_DEPENDS" "PROGRAMS" ${ARGN})
  install(TARGETS ${ARG_PROGRAMS} DESTINATION usr/bin COMPONENT ${component})
  foreach(program ${ARG_PROGRAMS})
    set(man "${CMAKE_BINARY_DIR}/packaging/${program}.1.gz")
    execute_process(COMMAND gzip -9nc "${TAUTLINE_PACKAGING}/man/${program}.1" OUTPUT_FILE "${man}" COMMAND_ERROR_IS_FATAL ANY)
    install(FILES "${man}" DESTINATION usr/share/man/man1 COMPONENT ${component})
  endforeach()
  install(FILES "${CMAKE_SOURCE_DIR}/LICENSE" DESTINATION usr/share/doc/tautline-${component} RENAME copyright
          COMPONENT ${component})
  install(FILES "${CMAKE_BINARY_DIR}/packaging/changelog.gz" DESTINATION usr/share/doc/tautline-${component}
          COMPONENT ${component})
  string(TOUPPER ${component} upper)
  set(depends "${ARG_DEPENDS}")
  if(CMAKE_CROSSCOMPILING)
    list(APPEND depends "${ARG_CROSS_DEPENDS}")
    list(JOIN depends ", " depends)
  endif()
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME tautline-${component} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_DESCRIPTION "${ARG_SUMMARY}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_RECOMMENDS "${ARG_RECOMMENDS}" PARENT_SCOPE)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
endfunction()

file(MAKE_DIRECTORY "${CMAKE_BINARY_DIR}/packaging")
execute_process(COMMAND gzip -9nc "${TAUTLINE_PACKAGING}/changelog" OUTPUT_FILE "${CMAKE_BINARY_DIR}/packaging/changelog.gz"
                COMMAND_ERROR_IS_FATAL ANY)

set(base "libc6 (>= 2.35), libgcc-s1 (>= 3.4), libstdc++6 (>= 11), libtomlplusplus3 (>= 3.2.0)")
set(base_lcm "${base}, liblcm1")

tautline_package(station
  PROGRAMS tautline-station
  DEPENDS "adduser, iproute2, tautline-tools"
  CROSS_DEPENDS "${base_lcm}, libfmt9 (>= 9.1.0)"
  RECOMMENDS "psmisc"
  SUMMARY "Ground station of a tethered drone: the real-time loop
The loop that flies: driver, estimate, supervisor, mission, control,
telemetry over LCM; with systemd services and udev rules.
It comes up disarmed after every start.")
tautline_package(tools
  PROGRAMS tautline
  DEPENDS iproute2
  CROSS_DEPENDS "${base_lcm}, libfmt9 (>= 9.1.0)"
  RECOMMENDS "gnuplot-nox, psmisc"
  SUMMARY "Ground station of a tethered drone: operator's command line
Arms, takes off, flies missions and lands; checks and imports mission
files, shows what goes over LCM, records flights, reports what a log says,
and examines whether a machine is fit for flight.")
tautline_package(sim
  PROGRAMS tautline-sim
  CROSS_DEPENDS "${base_lcm}"
  SUMMARY "Ground station of a tethered drone: simulated machine
Drone, reel and tether with physics of their own behind the device's wire
protocol on a pseudo terminal; with scenes and missions to begin with.")
set(programs tautline-station tautline tautline-sim)
if(TARGET tautline-plan)
  tautline_package(plan
    PROGRAMS tautline-plan
    CROSS_DEPENDS "${base}, libfmt9 (>= 9.1.0), liboctomap1.9, libompl16"
    RECOMMENDS gnuplot-nox
    SUMMARY "Ground station of a tethered drone: offline planning
From a map and rewards for viewpoints to a mission file whose risk is
explained: risk-aware planners, reachable space, tether contacts.")
  list(APPEND programs tautline-plan)
  install(DIRECTORY config/risk DESTINATION usr/share/tautline COMPONENT plan)
endif()
add_custom_target(programs DEPENDS ${programs})

# The station's surroundings.
install(DIRECTORY toolchain/systemd/ DESTINATION lib/systemd/system COMPONENT station)
install(FILES toolchain/udev/60-tautline.rules DESTINATION lib/udev/rules.d COMPONENT station)
install(FILES config/station_fotokite.toml DESTINATION etc/tautline RENAME station.toml COMPONENT station)
install(FILES config/station_tautline_can.toml config/station_tautline_serial.toml config/station_replay.toml config/tautline.dbc
        DESTINATION usr/share/doc/tautline-station/examples COMPONENT station)
install(FILES "${TAUTLINE_PACKAGING}/logger.conf" "${TAUTLINE_PACKAGING}/can.conf" DESTINATION etc/tautline COMPONENT station)
install(FILES "${TAUTLINE_PACKAGING}/limits.conf" DESTINATION etc/security/limits.d RENAME tautline.conf COMPONENT station)
install(FILES "${TAUTLINE_PACKAGING}/lintian-overrides" DESTINATION usr/share/lintian/overrides RENAME tautline-station
        COMPONENT station)
set(CPACK_DEBIAN_STATION_PACKAGE_CONTROL_EXTRA
  "${TAUTLINE_PACKAGING}/station/postinst;${TAUTLINE_PACKAGING}/station/prerm;${TAUTLINE_PACKAGING}/station/postrm"
  "${TAUTLINE_PACKAGING}/station/conffiles")
# The simulator's surroundings.
install(FILES config/sim.toml config/station.toml DESTINATION usr/share/tautline COMPONENT sim)
install(DIRECTORY config/scenes config/missions DESTINATION usr/share/tautline COMPONENT sim
        FILES_MATCHING PATTERN "*.toml")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME tautline)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_CONTACT "Tautline developers <tautline@tautline.invalid>")
set(CPACK_PACKAGING_INSTALL_PREFIX /)
set(CPACK_PACKAGE_DIRECTORY "${CMAKE_SOURCE_DIR}/build/package")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|amd64)$")
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE amd64)
endif()  # else CPack asks dpkg
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)
else()
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
endif()
include(CPack)
