//! Jumps, loops, repeated sections, calls and variables.

use super::*;

#[test]
fn loops_and_branches_run_as_often_as_they_say() {
    for (lines, length) in [
        ("G91\nFOR R1=1 TO 4\nG1 X1\nENDFOR", 4.0),
        ("G91\nDEF INT KK\nFOR KK=4 TO 1\nG1 X1\nENDFOR\nG1 X2", 2.0),
        ("DEF REAL DEPTH=0\nG91\nWHILE DEPTH>-3\nDEPTH=DEPTH-1\nG1 X1\nENDWHILE", 3.0),
        ("G91\nR1=0\nREPEAT\nR1=R1+1\nG1 X1\nUNTIL R1>=3", 3.0),
        ("G91\nR1=0\nLOOP\nR1=R1+1\nG1 X1\nIF R1==5 GOTOF OUT\nENDLOOP\nOUT: G1 X1", 6.0),
        ("R1=1\nIF R1==1\nG1 X5\nELSE\nG1 X7\nENDIF", 5.0),
        ("R1=2\nIF (R1==1) OR (R1==3)\nG1 X5\nELSE\nIF R1==2\nG1 X7\nENDIF\nENDIF", 7.0),
        ("GOTOF N100\nG1 X1\nN100 G1 X3", 3.0),
        ("R1=0\nAGAIN:\nR1=R1+1\nG91 G1 X1\nIF R1<3 GOTOB AGAIN", 3.0),
        ("GOTO L_END\nG1 X1\nL_END: G1 X4", 4.0),
        ("GOTOC NOWHERE\nG1 X4", 4.0),
        ("R1=2\nCASE R1 OF 1 GOTOF AA 2 GOTOF BB DEFAULT GOTOF CC\nAA: G1 X1\nBB: G1 X2\nCC:", 2.0),
        ("R1=7\nCASE R1 OF 1 GOTOF AA 2 GOTOF BB DEFAULT GOTOF CC\nAA: G1 X1\nBB: G1 X2\nCC: G1 X3", 3.0),
        ("G91\nSTEP: G1 X1\nREPEAT STEP P=3", 4.0),
        ("G91\nFIRST: G1 X1\nLAST: G1 X2\nG1 X4\nREPEAT FIRST LAST P2", 13.0),
        ("G91\nONE: G1 X1\nG1 X2\nREPEATB ONE P=3", 6.0),
        ("G91\nPART: G1 X1\nENDLABEL: G1 X2\nG1 X10\nREPEAT PART", 16.0),
        ("G91\nONE: G1 X1\nREPEATB ONE P=0", 1.0),
    ] {
        close(&[cut(lines)], &[length]);
    }
}

#[test]
fn variables_hold_what_their_kind_allows() {
    for (lines, x) in [
        ("DEF INT KK=2.5\nG0 X=KK", 3.0),
        ("DEF REAL AA[3]=(1,2,3), BB=4\nG0 X=AA[2]+BB", 7.0),
        ("DEF REAL AA[2]\nAA[1]=5\nG0 X=AA[1]", 5.0),
        ("DEF BOOL ON=7\nG0 X=ON", 1.0),
        ("R[3]=8\nR1=3\nG0 X=R[R1]", 8.0),
        ("DEF STRING[20] NAME=\"AB\"\nIF NAME==\"AB\" GOTOF OK\nG0 X1\nOK: G0 Y1", 0.0),
    ] {
        close(&[end(lines)[0]], &[x]);
    }
}

#[test]
fn subprograms_take_values_and_repeat() {
    let text = "%_N_MAIN_MPF\n;$PATH=/_N_WKS_DIR\nEXTERN ROW(REAL,INT)\nG710 G17 G90 G94 G54 F600\nG0 X0 Y0 Z0\n\
                ROW(5,2)\nL100 P3\nROW(,) P2\nL100\nM30\n\
                %_N_ROW_SPF\nPROC ROW(REAL LEN=1, INT COUNT) DISPLOF\nG91 G1 X=LEN\nY=COUNT\nRET\n\
                %_N_L100_SPF\nG91 G1 X1\nM17\n";
    close(&[measures(text).cutting_length_mm], &[7.0 + 3.0 + 2.0 + 1.0]);
    // Percent signs alone begin no program.
    let marked = "%_N_PART_MPF\n%\nG0 X0 Y0 Z0\nG1 X5 F100\nM30\n%\n";
    close(&[measures(marked).cutting_length_mm], &[5.0]);
    let nested = "G710 G90 F600\nG0 X0 Y0 Z0\nOUTER\nM30\nPROC OUTER\nDEF REAL AA=3\nINNER(AA*2)\nG1 X=AA\nRET\n\
                  PROC INNER(REAL AA)\nG1 X=AA\nM30";
    close(&[measures(nested).cutting_length_mm], &[9.0]);
}

#[test]
fn every_run_ends() {
    let endless = |lines: &str| faults(&framed(lines)).pop().unwrap().2;
    assert_eq!(endless("LOOP\nENDLOOP"), Fault::Endless(5_000_000));
    assert_eq!(endless("AA: R1=1\nREPEAT AA P=2000000000"), Fault::Endless(5_000_000));
    assert_eq!(endless("AA:\nREPEATB AA P=2000000000"), Fault::Endless(5_000_000));
    assert_eq!(faults("EMPTY P2000000000\nM30\nPROC EMPTY\nRET")[0].2, Fault::Endless(5_000_000));
    assert_eq!(faults("SELF_CALL\nM30\nPROC SELF_CALL\nSELF_CALL\nRET")[0].2, Fault::DeepCalls(16));
    assert_eq!(
        endless("MCALL CYCLE83(9,0,1,-9999,,-0.1)\nLOOP\nG0 X1 Y1\nENDLOOP"),
        Fault::TooManyMoves(200_000)
    );
    assert_eq!(framed_faults("R1=1\nAA: IF R1==1 GOTOB AA")[0].2, Fault::Endless(5_000_000));
}

#[test]
fn a_modal_program_runs_behind_each_block_that_moves() {
    let text = "G17 G710 G90 G54\nG0 X0 Y0 Z0 D1\nF600 S1000 M3\nMCALL SIDE(2)\nG1 X10\nM8\nX20\nMCALL\nX30\nM30\nPROC SIDE(REAL BY)\nG91\nG1 Y=BY\nG90\nRET\n";
    assert_eq!(of(text).end.map(Option::unwrap), [30.0, 4.0, 0.0]);
    // The moves of another program may or may not call it.
    let other = text.replace("X20\n", "OTHER\n") + "PROC OTHER\nX20\nRET\n";
    assert_eq!(faults(&other)[0].2, Fault::ModalInCall);
    let pattern = text.replace("X20\n", "HOLES1(0,0,0,0,10,3)\n");
    assert_eq!(faults(&pattern)[0].2, Fault::NotRead);
    assert_eq!(faults(&text.replace("MCALL\nX30\nM30", "X30 M30"))[0].2, Fault::NotRead);
    assert_eq!(faults(&text.replace("SIDE(2)", "NONE(2)"))[0].2, Fault::NotRead);
}

#[test]
fn a_text_names_a_program_to_call() {
    let text = "G17 G710 G90 G54\nG0 X0 Y0 Z0 D1\nF600\nDEF STRING[20] WHO\nWHO=\"side\"\nCALL \"/_N_WKS_DIR/_N_PART_WPD/_N_SIDE_SPF\"\nCALL WHO\nM30\nPROC SIDE\nG91 G1 Y2\nG90\nRET\n";
    assert_eq!(of(text).end[1], Some(4.0));
    assert_eq!(faults(&text.replace("CALL WHO", "CALL \"NONE\""))[0].2, Fault::NoProgram);
    assert_eq!(faults(&text.replace("CALL WHO", "CALL 5"))[0].2, Fault::NoProgram);
    assert_eq!(faults(&text.replace("CALL WHO", "CALL WHO BLOCK A TO B"))[0].2, Fault::NotRead);
}
