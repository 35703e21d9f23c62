#pragma once

#include <stdexcept>
#include <string>

namespace palpate::identify {

// Small files as programs write them.

inline const std::string trc_sample =
    "PathFileType\t4\t(X/Y/Z)\trun.trc\n"
    "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\tOrigDataRate\tOrigDataStartFrame\tOrigNumFrames\n"
    "100.00\t100.00\t3\t2\tcm\t100.00\t1\t3\n"
    "Frame#\tTime\tBase\t\t\tTip\t\t\t\n"
    "\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n"
    "\n"
    "1\t0\t1\t2\t3\t4\t5\t6\n"
    "2\t0.01\t1.1\t2\t3\t\t\t\n"
    "3\t0.02\t1.2\t2\t3\t4.1\t5\t6\n";

inline const std::string motive_sample =
    "Format Version,1.23,Take Name,Take 1,Capture Frame Rate,240,Export Frame Rate,240,Capture Start Time,2020-10-01 "
    "10.00.00.000 AM,Total Frames in Take,2,Rotation Type,Quaternion,Length Units,Meters,Coordinate Space,Global\r\n"
    "\r\n"
    ",Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body "
    "Marker,Rigid Body Marker,Rigid Body Marker,Rigid Body Marker,Marker,Marker,Marker,Marker,Marker,Marker\r\n"
    ",Name,Plate,Plate,Plate,Plate,Plate,Plate,Plate,Plate,Plate:Marker1,Plate:Marker1,Plate:Marker1,Plate:Marker1,"
    "Plate:Marker1,Plate:Marker1,Plate:Marker1,Unlabeled 7,Unlabeled 7,Unlabeled 7\r\n"
    ",ID,A,A,A,A,A,A,A,A,B,B,B,B,C,C,C,D,D,D\r\n"
    ",,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,Position,Position,Position,"
    "Marker Quality,Position,Position,Position,Position,Position,Position\r\n"
    "Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X,Y,Z,,X,Y,Z,X,Y,Z\r\n"
    "0,0.000000,0,0,0,1,0.1,0.2,0.3,0.0001,0.1,0.2,0.3,1,0.11,0.2,0.3,,,\r\n"
    "1,0.0041667,0,0,0,1,0.1,0.2,0.3,0.0001,0.1,0.2,0.3,1,0.12,0.2,0.3,0.31,0.32,0.33\r\n";

inline const std::string vicon_sample =
    "Events\n100\nSubject,Context,Name,Time (s),Description\nArm,Left,Foot Strike,0.015,touches\n\n"
    "Devices\n200\n,,Plate - Force,Plate - Moment\nFrame,Sub Frame,Fx,Mx\n,,N,N.mm\n"
    "1,0,1.5,10\n1,1,1.6,11\n2,0,1.7,12\n2,1,1.8,13\n\n"
    "Model Outputs\n100\n,,Arm:Elbow,,\nFrame,Sub Frame,X,Y,Z\n,,deg,deg,deg\n1,0,90,0,0\n2,0,91,0,0\n\n"
    "Trajectories\n100\n,,Arm:LASI,,,Arm:RASI,,\nFrame,Sub Frame,X,Y,Z,X,Y,Z\n,,mm,mm,mm,mm,mm,mm\n"
    "1,0,1,2,3,4,5,6\n2,0,1.1,2.1,3.1,4.5,5.5,6.5\n";

inline const std::string bluehill_sample =
    "\"Specimen label\",\"silicone 1\"\r\n\"Operator\",\"A, B\"\r\n\"Rate 1\",\"10.00000\",\"mm/min\"\r\n\r\n"
    "\"Results Table 1\"\r\n\"\",\"Maximum "
    "Load\",\"Modulus\"\r\n\"\",\"(N)\",\"(MPa)\"\r\n\"1\",\"12.4\",\"0.31\"\r\n\r\n"
    "\"Time\",\"Extension\",\"Load\"\r\n\"(sec)\",\"(mm)\",\"(kN)\"\r\n"
    "\"0.00\",\"0.000\",\"0.0010\"\r\n\"0.10\",\"0.017\",\"0.0015\"\r\n\"0.20\",\"0.033\",\"0.0021\"\r\n";

/// As testXpert writes it in German, in Latin-1.
inline const std::string zwick_sample =
    "\"Pr\xFC"
    "fprotokoll\";\"testXpert II\"\r\n\"Kunde\";\"M\xFCller\"\r\n"
    "\"Pr\xFC"
    "fzeit\";\"Standardweg\";\"Standardkraft\"\r\n\"s\";\"mm\";\"N\"\r\n"
    "0,00;0,000;1.234,5\r\n0,10;0,017;1.235,25\r\n0,20;0,033;1.240,0\r\n";

inline const std::string dice_sample =
    "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA,GAMMA,BETA,STATUS_FLAG\n"
    "0,100,200,0.5,-0.25,0.01,0.02,0,4\n1,120,200,0,0,-1,0,0,11\n";

inline const std::string aramis_sample =
    "# GOM Aramis export\n# stage 3\n#     ID;    x_undef [mm];   y_undef [mm];  z_undef [mm];  u [mm]; v [mm]; w "
    "[mm]\n"
    "7;1,5;2;3;0,1;0,2;0,3\n9;4;5;6;0,4;NaN;0,6\n";

inline const std::string vic_sample =
    "\"X\", \"Y\", \"Z\", \"U\", \"V\", \"W\", \"exx\", \"sigma\", \"x\", \"y\"\n"
    "1, 2, 3, 0.1, 0.2, 0.3, 0.001, 0.01, 500, 600\n4, 5, 6, 0, 0, 0, 0, -1, 510, 600\n";

inline const std::string long_sample = "frame,marker,x,y,z\n0,a,1,2,3\n0,b,4,5,6\n1,b,4.5,5,6\n1,a,1.5,2,3\n";

inline const std::string ply_sample =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 "
    "0\n1 0 "
    "0\n0 1 0\n";

inline const std::string vtk_sample =
    "# vtk DataFile Version 3.0\na\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 1 0 0\nVERTICES 2 4\n1 0\n1 1\n"
    "POINT_DATA 2\nVECTORS displacement float\n0 0 1 0 0 2\nSCALARS id float 1\nLOOKUP_TABLE default\n12 15\n";

/// The text with one thing in the place of another. @throws std::logic_error where it does not hold that.
inline std::string replaced(std::string text, const std::string& old, const std::string& other) {
    const std::size_t at = text.find(old);
    if (at == std::string::npos) throw std::logic_error("'" + old + "' is not in the sample");
    return text.replace(at, old.size(), other);
}

}  // namespace palpate::identify
