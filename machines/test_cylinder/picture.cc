#include "machines/test_cylinder/kind.h"

namespace hydroscope {

MachinePicture TestCylinderPicture() {
  MachinePicture picture;
  picture.drawing = R"svg(
    <rect class="body" x="40" y="146" width="76" height="44" rx="3"/><path class="thin" d="M52 178H72V158H104"/>
    <path class="signal" d="M116 168H196m-6 -4l6 4l-6 4"/>
    <rect class="body" x="196" y="148" width="108" height="40" rx="3"/><path d="M232 148V188M268 148V188"/>
    <path class="thin" d="M206 168h16m-5 -4l5 4l-5 4M242 160h16M242 176h16M278 168h16m-11 -4l-5 4l5 4"/>
    <path class="pipe" d="M214 148V106M286 148V106M226 188V224M276 188V206"/>
    <path class="pipe" d="M212 224v12h28v-12"/>
    <circle class="body" cx="276" cy="218" r="12"/><path class="fill" d="M270 220l6 -10l6 10z"/>
    <path class="rod" d="M120 82H404"/><rect class="body" x="176" y="58" width="148" height="48" rx="3"/>
    <path class="rod" d="M178 82H322"/><rect class="fill" x="242" y="59" width="16" height="46"/>
    <path class="thin" d="M404 66V98"/>
    <path class="signal" d="M404 98V254H78V190m-4 6l4 -6l4 6"/>)svg";
  picture.places = {{"z_set", 46, 100, 62, 146}, {"I_v", 150, 124, 150, 168}, {"z", 440, 50, 404, 76}};
  return picture;
}

}  // namespace hydroscope
