O4003
(CONTROL fanuc-0i-mate-tb)
(Turning cycle G90, straight)
(As printed, with its remarks after a semicolon put into English)
N10 T0101
N20 G0 X31. Z1. S800 M03 ;rapid to the start of the cycle
N30 G90 X26. Z-24.9 F0.3 ;roughing, leaves 0.1 mm on the face
N40 X22. ;the cycle stays active, down to 22 mm
N50 X20.5 ;leaves 0.25 mm a side
N70 X20. Z-25. F0.2 S1200 ;finishing
N80 G28 X100. Z100.
N90 M30
