O4008
(CONTROL fanuc-0i-mate-tb)
(INTENDED MISTAKE, as printed: N120 finishes only to N100, the roughing figure ends at N110)
N10 T0101
N20 G0 X46. Z0.5 S500 M03
N30 G71 U2. R0.5 (2 mm a pass, 0.5 mm escape)
N40 G71 P50 Q110 U0.3 W0.1 F0.3 (allowances 0.3 mm on the diameter, 0.1 mm in Z)
N50 G1 X15.
N60 G1 Z0 F0.15 S800 (feed and speed of the finishing cut)
N70 Z-15.
N80 X30. Z-30.
N90 Z-42.
N100 G2 X36. Z-45. R3.
N110 G1 X46.
N120 G70 P50 Q100 (finishing)
N130 G28 X100. Z100.
N140 M5
N150 M30
