#include "machines/pump/kind.h"

namespace hydroscope {

MachinePicture PumpPicture() {
  MachinePicture picture;
  picture.height = 300;
  picture.drawing = R"svg(
    <circle class="body" cx="46" cy="160" r="22"/><text class="sign" x="46" y="165">M</text>
    <path class="rod" d="M68 160H130"/><circle class="body" cx="164" cy="160" r="34"/>
    <path class="fill" d="M155 142l9 -15l9 15z"/><path class="thin" d="M128 198L202 120m-9 2l9 -2l-2 9"/>
    <path class="pipe" d="M164 126V72H440"/><path class="thin" d="M398 54q10 18 0 36M418 54q-10 18 0 36M392 96L426 50m-8 3l8 -3l-1 9"/>
    <path class="pipe" d="M164 194V214M150 214v12h28v-12"/>
    <path class="thin" d="M202 186H268"/><rect class="body" x="236" y="166" width="112" height="40" rx="3"/>
    <path class="thin" d="M206 186H286M240 176l5 -6l8 30l8 -30l8 30l8 -30l5 15"/><rect class="fill" x="286" y="167" width="14" height="38"/>
    <rect class="body" x="316" y="100" width="72" height="32" rx="3"/><path d="M352 100V132"/>
    <path class="thin" d="M325 126V106m-4 6l4 -6l4 6M362 106V126m-4 -6l4 6l4 -6M388 116l4 -7l6 14l6 -14l6 14l4 -7M416 106V126"/>
    <path class="pipe" d="M334 100V72M334 132V166M372 132V214M358 214v12h28v-12"/>
    <path class="signal" d="M304 72V116H316"/>)svg";
  picture.places = {{"shaft_speed", 66, 100, 100, 160},
                    {"outlet_pressure", 236, 26, 236, 72},
                    {"load_flow", 420, 22, 370, 72},
                    {"control_position", 210, 268, 220, 186},
                    {"control_pressure", 400, 268, 328, 190}};
  return picture;
}

}  // namespace hydroscope
