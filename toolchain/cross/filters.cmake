# Which tests of the cross-build run under qemu-user: those of common, and of the others those named here. Read by
# tautline_test() in a cross-build only. Left out is
# - what opens a terminal: qemu-user knows no termios2, with which the serial port sets any baud rate (./run pi runs the port
#   on a real arm64 kernel);
# - what flies hundreds of times, or tries millions of random inputs: minutes here. same_flight_* compares whole flights.
set(TAUTLINE_CROSS_FILTER_drivers_test
  "ParseTelemetry*:LineAssembler*:LineCounters*:FormatCommand*:OutputQueue*:Pace*-FormatCommand.RoundTrips*:ParseTelemetry.NeverAccepts*:LineAssembler.GivesTheSame*")
set(TAUTLINE_CROSS_FILTER_estimation_test
  "PublishedCatenary*:PositionFix*:SensorHealth*:LeanTension*:LeanModel*:ThrustElevation*:MapTension.Agrees*:TetherFilter*")
set(TAUTLINE_CROSS_FILTER_control_test "-*Flight*:RealTime*:AllCases*:*AreFiniteAndWithinTheLimits*:CommandGate.NothingItLets*")
set(TAUTLINE_CROSS_FILTER_station_test "EmulatedMachine*:InputMessage*:MissionStore*:TelemetryTest*-*SurvivesRandomChunks")
set(TAUTLINE_CROSS_FILTER_lockstep_test "Lockstep.RefusesToArm*:Lockstep.NavigateWithout*")
set(TAUTLINE_CROSS_FILTER_sim_hil_test NONE)  # the simulator stays on the host
