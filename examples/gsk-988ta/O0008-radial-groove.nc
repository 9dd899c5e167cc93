O0008
(CONTROL gsk-988ta)
(Radial groove G75: P and Q in units of 0.001 mm, P a radius)
(The page breaks off after the cycle; retreat and end as in the sister manual)
G00 X150 Z50 M3 S500 (spindle at 500 rpm);
G0 X125 Z-20 (to the start of the cycle);
G75 R0.5 F150 (return 0.5 mm);
G75 X40 Z-50 P6000 Q3000 (6 mm a peck, 3 mm to the next plunge);
G0 X150 Z50;
M30;
