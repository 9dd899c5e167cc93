O0005
(CONTROL gsk-988ta)
(Rough facing G72 and finishing G70)
(As printed, remarks put into English)
G00 X176 Z10 M3 S500 T0202 (tool 2 with offset 2, spindle at 500 rpm);
G72 W2.0 R0.5 F300 (2 mm a pass, 0.5 mm escape);
G72 P10 Q20 U0.2 W0.1 (roughing a to d, 0.2 mm left on X, 0.1 mm on Z);
N10 G00 Z-55 S800 (rapid move);
G01 X160 F120 (in to a);
X80 W20 (a to b);
W15 (b to c);
N20 X40 W20 (c to d);
G70 P10 Q20 (finishing a to d);
M30;
