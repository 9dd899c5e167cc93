O4007
(CONTROL fanuc-0i-mate-tb)
(Facing cycle G94)
(As printed)
N10 T0101
N20 G0 X52. Z1. S500 M03
N30 G94 X20.2 Z-2.F0.2 (first roughing cut, 2 mm deep in Z)
N40 Z-4.
N50 Z-6.
N60 Z-8.
N70 Z-9.8
N80 X20. Z-10. S900 (finishing)
N90 G28 X100. Z100.
N100 M30
