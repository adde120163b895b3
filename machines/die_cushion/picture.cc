#include "machines/die_cushion/kind.h"

namespace hydroscope {

MachinePicture CushionPicture() {
  MachinePicture picture;
  picture.drawing = R"svg(
    <rect class="fill" x="120" y="24" width="100" height="14" rx="2"/><path class="rod" d="M170 38V132"/>
    <rect class="body" x="130" y="90" width="80" height="110" rx="3"/><path class="rod" d="M170 92V130"/>
    <rect class="fill" x="131" y="130" width="78" height="14"/><path class="thin" d="M122 30V140"/>
    <path class="pipe" d="M210 180H270V172M300 172V240M340 172V206"/>
    <rect class="body" x="250" y="132" width="110" height="40" rx="3"/><path d="M286 132V172M323 132V172"/>
    <path class="thin" d="M262 152h14m-5 -4l5 4l-5 4M297 145h16M297 159h16M334 152h14m-9 -4l-5 4l5 4M360 142h14v20h-14"/>
    <path class="pipe" d="M285 240v14h30v-14"/>
    <circle class="body" cx="340" cy="218" r="12"/><path class="fill" d="M334 220l6 -10l6 10z"/>)svg";
  picture.places = {{"z", 60, 40, 122, 60},       {"p_B", 60, 112, 140, 112},  {"p_A", 60, 172, 140, 172},
                    {"T_oil", 60, 232, 140, 190}, {"U_v", 430, 112, 374, 150}, {"y_v", 318, 92, 318, 132},
                    {"p_0", 430, 190, 340, 190},  {"p_t", 430, 240, 300, 236}};
  return picture;
}

}  // namespace hydroscope
