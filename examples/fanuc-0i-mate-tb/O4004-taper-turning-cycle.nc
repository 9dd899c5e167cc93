O4004
(CONTROL fanuc-0i-mate-tb)
(Turning cycle G90 with a taper: R is negative, larger toward the chuck)
(As printed)
N10 T0101
N20 G0 X32.Z0.5 S500 M3 (to the start of the cycle)
N30 G90 X26. Z-25. R-2.5 F0.15 (roughing)
N40 X22.
N50 X20.5 (0.5 mm on the diameter left for finishing)
N60 G0 Z0 S800 M3
N70 G90 X20. Z-25. R-2.5 F0.1
N80 G28 X100. Z100.
N90 M5
N100 M2
