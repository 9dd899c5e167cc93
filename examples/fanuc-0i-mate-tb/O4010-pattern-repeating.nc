O4010
(CONTROL fanuc-0i-mate-tb)
(Pattern repeating G73 for a forging, and finishing G70)
(Print corrected: the count in N30 is R3, printed R3. with a point)
N10 T0101
N20 G0 X110. Z10. S800 M3
N30 G73 U5. W3. R3
N40 G73 P50 Q110 U0.4 W0.1 F0.3
N50 G0 X50. Z1. S1000
N60 G1 Z-10. F0.15
N70 X60. Z-15.
N80 Z-25.
N90 G2 X80. Z-35. R10.
N100 G1 X90. Z-40.
N110 G0 X110. Z10.
N120 G70 P50 Q110
N130 G28 X100. Z150.
N140 M30
