#include "machines/flexible_axis/kind.h"

namespace hydroscope {

MachinePicture FlexibleAxisPicture() {
  MachinePicture picture;
  picture.drawing = R"svg(
    <path class="thin" d="M222 146H470M230 146l-8 8M254 146l-8 8M278 146l-8 8M302 146l-8 8M326 146l-8 8M350 146l-8 8M374 146l-8 8M398 146l-8 8M422 146l-8 8M446 146l-8 8"/>
    <rect class="body" x="48" y="90" width="142" height="44" rx="3"/><path class="rod" d="M118 112H240"/>
    <rect class="fill" x="108" y="91" width="14" height="42"/>
    <rect class="body" x="240" y="84" width="56" height="54" rx="3"/>
    <circle class="body" cx="252" cy="142" r="4"/><circle class="body" cx="284" cy="142" r="4"/>
    <path class="thin" d="M296 98h8l5 -8l9 16l9 -16l9 16l9 -16l5 8h16M296 124h24M320 112V136H346M320 112H346M336 115V133M336 124H370"/>
    <rect class="body" x="370" y="76" width="70" height="62" rx="3"/>
    <circle class="body" cx="384" cy="142" r="4"/><circle class="body" cx="426" cy="142" r="4"/>
    <path class="pipe" d="M78 134V184M160 134V184M94 224V234M146 224V246"/>
    <rect class="body" x="64" y="184" width="112" height="40" rx="3"/><path d="M101 184V224M139 184V224"/>
    <path class="thin" d="M74 204h16m-5 -4l5 4l-5 4M112 196h16M112 212h16M150 204h16m-11 -4l-5 4l5 4"/>
    <circle class="body" cx="94" cy="246" r="12"/><path class="fill" d="M88 248l6 -10l6 10z"/>
    <path class="pipe" d="M132 246v12h28v-12"/>
    <path class="signal" d="M30 204H64m-6 -4l6 4l-6 4"/>)svg";
  picture.places = {{"pressure_1", 56, 40, 78, 102},      {"pressure_2", 172, 40, 156, 102},
                    {"position", 276, 40, 240, 90},       {"load_position", 404, 36, 404, 76},
                    {"acceleration", 268, 186, 268, 138}, {"U", 34, 166, 34, 204}};
  return picture;
}

}  // namespace hydroscope
