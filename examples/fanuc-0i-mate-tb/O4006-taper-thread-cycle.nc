O4006
(CONTROL fanuc-0i-mate-tb)
(Thread cycle G92 on a taper)
(The print breaks off after N50; the retreat in N60 and the end in N70 are added)
N10 T0101
N20 G0 X25. Z5. S300 M3 (Z0)
N30 G92 X19.6 Z-20. R-2.5 F1.5
N40 X19.4
N50 X19.
N60 G0 X100. Z100. M5
N70 M30
