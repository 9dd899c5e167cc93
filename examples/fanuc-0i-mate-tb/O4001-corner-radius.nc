O4001
(CONTROL fanuc-0i-mate-tb)
(Rounded corners in G01: R with the sign of the next move)
(As printed)
N10 T0101
N20 G0 X0 Z1. S500 M03
N30 G1Z0 F0.2
N40 G1 X20. R-5.
N50 G1 Z-25. R3.
N60 G1 X30.5
N70 G28 X120. Z100.
N80 M30
