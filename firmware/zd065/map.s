; Where everything lies: memory, the ports of the 6522s, zero page.
;
; The paper gives 4,096 bytes of data, two 4K EPROMs and three 6522 [S]; every address is
; reconstructed [R]. The data lie apart from zero page and stack: of a RAM that holds all three, 585
; lines (4,095 bytes and the end byte [D]) would not fit.
; Marks: [S] said by the paper, [D] derived from it, [R] reconstructed, [M] measured by us.

; --- memory -----------------------------------------------------------------------------------
;   $0000..$00FF  zero page          $2000..$2FFF  data of the program
;   $0100..$01FF  stack              $A000..$A02F  three 6522
;                                    $E000..$FFFF  this program, two 4K EPROMs
.alias data        $2000
.alias data_end    $3000        ; first address behind the data
.alias rom         $E000

; --- first 6522: motors, feed, generator, key --------------------------------------------------
; Port A, out: PA0..PA2 phases A, B, C of x, PA3..PA5 those of y.
; CA1, in: the feed signal, one edge a step. Its flag goes out when port A is written, so that the
;   step itself takes the feed and nothing else has to be done [R]. The interrupt line of this 6522
;   is not connected: bit 7 of its flags is only looked at.
; CB1, in: the operator's key 'go on', one edge a press [R].
; Port B, out: PB0, 1 the generator cuts.
.alias motors      $A001
.alias flags       $A00D        ; bits 7 and 1: a feed edge came; bit 4: the key was pressed
.alias feed        $02
.alias key         $10
.alias generator   $A000
.alias via1_ddrb   $A002
.alias via1_ddra   $A003
.alias via1_acr    $A00B
.alias via1_pcr    $A00C
.alias via1_ier    $A00E

; --- second 6522: display ---------------------------------------------------------------------
; Port A: segments a..g of the digit that is lit; port B: PB0..PB5 which digit, PB0 the first.
; Timer 1 interrupts every 2 ms at 1 MHz: six digits 83 times a second [R].
.alias digits      $A010
.alias segments    $A011
.alias via2_ddrb   $A012
.alias via2_ddra   $A013
.alias timer       $A014
.alias timer_high  $A015
.alias via2_acr    $A01B
.alias via2_ier    $A01E
.alias scan_time   1998         ; cycles between two interrupts, less 2 [D]: the timer adds them

; The third 6522, $A020, is free for the keyboard.

; --- zero page: what a display and a saved state show, one block ------------------------------
.alias f           $10          ; 4: the deviation F, signed, low byte first; lines use 3
.alias j           $14          ; 3: J left, um, packed BCD, high byte first as in the data
.alias number      $18          ; 3: number of the block, from 1, packed BCD, high byte first
.alias message     $1C          ; 3: what the display shows of an error: E, its code, the block
; (the groups that the display shows begin at multiples of 4: see display.s)

; --- zero page: the block ---------------------------------------------------------------------
.alias at          $20          ; 2: address of the block
.alias next        $22          ; 2: address of the next one
.alias code        $24          ; its instruction, repaired
.alias group       $25          ; instruction without its quadrant
.alias shift       $26          ; how many bytes of a number are left to convert
.alias quadrant    $27          ; 1..4, repaired
.alias number_bin  $28          ; 4: a number on its way from BCD to binary
.alias ten         $2C          ; 3: likewise, its double
.alias x_um        $30          ; 3: |x|, um, low byte first
.alias y_um        $33          ; 3: |y|
.alias zero_x      $36          ; 0 where x is 0
.alias zero_y      $37

; --- zero page: the interpolator --------------------------------------------------------------
; u is the axis of the steps at F >= 0, v that of the steps at F < 0.
.alias less        $40          ; 4: what a step at F >= 0 takes from F: 2u - 1, of lines |y|
.alias more        $44          ; 4: what a step at F < 0 adds to F: 2v + 1, of lines |x|
.alias sector      $48          ; arcs: 0..3 NR1..NR4, 4..7 SR1..SR4, as run now
.alias left        $49          ; 2: high bytes of the steps until |x| = |y|; the low one is in X
.alias half        $4B          ; 4: twice those steps, while they are worked out

; --- zero page: motors ------------------------------------------------------------------------
.alias step_u      $50          ; 2: the table of the ring steps along u; see ring.s
.alias step_v      $52          ; 2: along v
.alias ring_u      $54          ; 2: the same while play is to be taken up; its second byte is free
.alias ring_v      $56
.alias phases      $58          ; what port A shows while no block runs
.alias last_x      $59          ; x_plus or x_minus: direction of the last step on x
.alias last_y      $5A
.alias play_x      $5B          ; steps that take up the play, 0..255
.alias play_y      $5C
.alias entered     $5D          ; not 0: the play has been entered
.alias pace        $5E          ; ms between two of those steps, at 1 MHz; 0 none
.alias pulses      $5F          ; how many are left
.alias table       $60          ; 2: the table that they use
.alias keep        $62          ; X of the loop meanwhile

; --- zero page: the program and the machine ---------------------------------------------------
.alias state       $70          ; one of the six below
.alias error       $71          ; one of the seven below, 0 none
.alias repaired    $72          ; instructions repaired so far, modulo 256
.alias shown       $73          ; address of the 3 bytes that the display shows
.alias digit       $74          ; which digit is lit next, 0..5
.alias square      $78          ; 6: x^2 + y^2, low byte first; see radius.s
.alias factor      $7E          ; 6
.alias bits        $84          ; 3

.alias idle        0
.alias cutting     1
.alias moving      2            ; generator off
.alias waiting     3            ; thread point or pause
.alias ended       4
.alias stopped     5            ; by an error

.alias no_instruction  1
.alias bad_digit       2
.alias no_step         3        ; J is 0, or a line has no length
.alias too_small       4        ; R^2 < 2: such an arc steps onto its centre and never ends
.alias too_large       5        ; R > 10,000,000 um
.alias no_end          6        ; the data run over the end of their memory
.alias no_play         7        ; play has not been entered

; --- instructions [R] -------------------------------------------------------------------------
; The quadrant, 1..4, is added to the first four.
.alias line_code   $00
.alias sr_code     $10          ; clockwise
.alias nr_code     $20          ; counter-clockwise
.alias move_code   $40
.alias thread_code $30
.alias pause_code  $31
.alias end_code    $00
