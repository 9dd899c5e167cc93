O4002
(CONTROL fanuc-0i-mate-tb)
(A 45 degree chamfer and a rounded corner in G01, letters without a comma)
(As printed)
N10 T0101
N20 G0 X0 Z1. S500 M03
N30 G1Z0 F0.2
N40 G1 X20. C-2.
N50 G1 Z-25. R3.
N60 G1 X30.5
N70 G28 X120. Z100.
N80 M30
