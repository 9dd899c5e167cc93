O4011
(CONTROL fanuc-0i-mate-tb)
(Example 4-11: a round recess with G73, relief in X only; the number O4011 is ours)
(Print corrected: Q80 in N50 and N90, printed Q90; count R3 without a point)
N10 T0101 (pointed tool)
N20 S500 M3
N30 G0 X50. Z-10.
N40 G73 U4. W0 R3
N50 G73 P60 Q80 U0.4 W0 F0.3
N60 G1 X30. F0.8
N70 G2 X30. Z-30. R15. F0.15
N80 G0 X50. Z-10.
N90 G70 P60 Q80
N100 G0 X100. Z100. M5
N110 M30
