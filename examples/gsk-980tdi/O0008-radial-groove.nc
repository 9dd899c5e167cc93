O0008
(CONTROL gsk-980tdi)
(Radial groove G75 with a 4 mm tool: P and Q in units of 0.0001 mm, P a diameter)
(As printed, remarks put into English; the setup file beside it sets the increment)
G00 X150 Z50 M3 S500 (rapid move, spindle at 500 rpm);
G0 X125 Z-24 (to the start, worked out from the tool width);
G75 R0.5 F150 (return 0.5 mm);
G75 X40 Z-50 P60000 Q30000 (6 mm a peck on the diameter, 3 mm to the next plunge);
G0 X150 Z50 (back to a safe point);
M30 (end);
