O4010
(CONTROL fanuc-0i-mate-tb)
(O4010 from solid bar: G73 with relief in X only, 13 passes)
(Print corrected: figure renumbered by ten for the added block, Q120 and R13 without a point)
N10 T0101
N20 G0 X110. Z10. S800 M3
N30 G0 X150. Z1.
N40 G73 U25. W0 R13
N50 G73 P60 Q120 U0.4 W0.1 F0.3
N60 G0 X50. Z1. S1000
N70 G1 Z-10. F0.15
N80 X60. Z-15.
N90 Z-25.
N100 G2 X80. Z-35. R10.
N110 G1 X90. Z-40.
N120 G0 X150. Z1.
N130 G70 P60 Q120
N140 G28 X100. Z150.
N150 M30
