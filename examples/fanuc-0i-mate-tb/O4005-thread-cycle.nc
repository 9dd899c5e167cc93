O4005
(CONTROL fanuc-0i-mate-tb)
(Thread cycle G92, straight)
(Only the thread is printed; the retreat in N200 and the end in N210 are added)
N110 T0303
N120 G0 X28. Z5. S350 M3 (to the start of the cycle)
N130 G92 X19.4 Z-23. F1.5 (first pass)
N140 X19. (deeper pass by pass)
N150 X18.6
N160 X18.2
N170 X18.
N180 X17.9
N190 X17.8
N200 G0 X100. Z100. M5
N210 M30
