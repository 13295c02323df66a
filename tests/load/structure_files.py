"""Small structure files made for the tests."""

from __future__ import annotations


def pdb_atom(
    serial: object = 1,
    name: str = " CA ",
    residue: str = "ALA",
    chain: str = "A",
    number: object = 1,
    xyz: tuple[object, object, object] = (1.0, 2.0, 3.0),
    *,
    altloc: str = " ",
    insertion: str = " ",
    occupancy: float = 1.0,
    b: float = 20.0,
    element: str = " C",
    record: str = "ATOM",
) -> str:
    """One ATOM line; numbers are written as the format's guide says, texts as they are."""
    columns = [f"{c:8.3f}" if isinstance(c, float) else f"{c!s:>8}" for c in xyz]
    return (
        f"{record:<6}{serial!s:>5} {name:<4}{altloc}{residue:>3} {chain}{number!s:>4}{insertion}   "
        f"{''.join(columns)}{occupancy:6.2f}{b:6.2f}          {element:>2}\n"
    )


MOL = """ethanol

made for tests
  3  2  0  0  0  0  0  0  0  0999 V2000
    0.0000    0.0000    0.0000 C   0  0
    1.5000    0.0000    0.0000 C   0  0
    2.2000    1.2000    0.0000 O   0  5
  1  2  1  0
  2  3  2  0
M  END
"""

MOL_V3000 = """ethanol

made for tests
  0  0  0     0  0            999 V3000
M  V30 BEGIN CTAB
M  V30 COUNTS 2 1 0 0 0
M  V30 BEGIN ATOM
M  V30 1 C 0 0 0 0
M  V30 2 O 1.2 -
M  V30 0 0 0 CHG=-1
M  V30 END ATOM
M  V30 BEGIN BOND
M  V30 1 2 1 2
M  V30 END BOND
M  V30 END CTAB
M  END
"""

XYZ = """3
water
O 0.0 0.0 0.0
1 0.96 0.0 0.0
H -0.24 0.93 0.0
"""

GRO = """water, one molecule
3
    1SOL     OW    1   0.000   0.000   0.000
    1SOL    HW1    2   0.096   0.000   0.000
    1SOL    HW2    3  -0.024   0.093   0.000
   1.0 1.0 1.0
"""

PQR = """ATOM      1  N   ALA A  10      1.000   2.000   3.000  0.1414 1.8240
ATOM      2  CA  ALA A  10      2.400   2.000   3.000  0.0962 1.9080
"""

MOL2 = """@<TRIPOS>MOLECULE
benzene part
2 1 0 0 0
SMALL
NO_CHARGES
@<TRIPOS>ATOM
1 C1 0.0 0.0 0.0 C.ar 7 BNZ7 0.0
2 C2 1.4 0.0 0.0 C.ar 7 BNZ7 0.0
@<TRIPOS>BOND
1 1 2 ar
"""

MMCIF = """data_TEST
loop_
_pdbx_struct_assembly_gen.assembly_id
_pdbx_struct_assembly_gen.oper_expression
_pdbx_struct_assembly_gen.asym_id_list
1 '(1,2)(3)' A
2 1-2 A,B
#
loop_
_pdbx_struct_oper_list.id
_pdbx_struct_oper_list.matrix[1][1]
_pdbx_struct_oper_list.matrix[1][2]
_pdbx_struct_oper_list.matrix[1][3]
_pdbx_struct_oper_list.matrix[2][1]
_pdbx_struct_oper_list.matrix[2][2]
_pdbx_struct_oper_list.matrix[2][3]
_pdbx_struct_oper_list.matrix[3][1]
_pdbx_struct_oper_list.matrix[3][2]
_pdbx_struct_oper_list.matrix[3][3]
_pdbx_struct_oper_list.vector[1]
_pdbx_struct_oper_list.vector[2]
_pdbx_struct_oper_list.vector[3]
1 1 0 0 0 1 0 0 0 1 0 0 0
2 0 -1 0 1 0 0 0 0 1 5 1 0
3 1 0 0 0 -1 0 0 0 -1 0 0 7
#
loop_
_atom_site.group_PDB
_atom_site.id
_atom_site.type_symbol
_atom_site.label_atom_id
_atom_site.label_alt_id
_atom_site.label_comp_id
_atom_site.label_asym_id
_atom_site.label_seq_id
_atom_site.pdbx_PDB_ins_code
_atom_site.Cartn_x
_atom_site.Cartn_y
_atom_site.Cartn_z
_atom_site.auth_seq_id
_atom_site.auth_asym_id
ATOM   1 C CA    . ALA A 1 ? 1.5  2 -3e0 10 X
ATOM   2 O "O5'" . ALA A 1 ? 2.5  2 -3   10 X
HETATM 3 MG MG   . MG  B . A 9    9 9    1  X
#
"""
