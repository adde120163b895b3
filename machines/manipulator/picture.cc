#include "machines/manipulator/kind.h"

namespace hydroscope {

MachinePicture ManipulatorPicture() {
  MachinePicture picture;
  picture.height = 348;
  picture.drawing = R"svg(
    <path class="thin" d="M60 324H240M70 324l-8 8M100 324l-8 8M130 324l-8 8M160 324l-8 8M190 324l-8 8M220 324l-8 8"/>
    <path class="body" d="M88 324L100 236H140L152 324Z"/>
    <g transform="translate(120 236) rotate(-49)"><rect class="body" x="-8" y="-10" width="200" height="20" rx="10"/></g>
    <g transform="translate(244 93) rotate(14)"><rect class="body" x="-8" y="-9" width="190" height="18" rx="9"/></g>
    <g transform="translate(146 300) rotate(-72)"><path class="rod" d="M60 0H124"/><rect class="body" x="0" y="-10" width="78" height="20" rx="3"/><rect class="fill" x="36" y="-9" width="8" height="18"/></g>
    <g transform="translate(206 150) rotate(-13)"><path class="rod" d="M70 0H142"/><rect class="body" x="0" y="-9" width="86" height="18" rx="3"/><rect class="fill" x="44" y="-8" width="8" height="16"/></g>
    <circle class="fill" cx="120" cy="236" r="6"/><circle class="fill" cx="244" cy="93" r="6"/>
    <circle class="fill" cx="146" cy="300" r="4"/><circle class="fill" cx="184" cy="182" r="4"/><circle class="fill" cx="206" cy="150" r="4"/><circle class="fill" cx="344" cy="118" r="4"/>
    <rect class="body" x="300" y="196" width="72" height="28" rx="3"/><path d="M324 196V224M348 196V224"/>
    <rect class="body" x="300" y="266" width="72" height="28" rx="3"/><path d="M324 266V294M348 266V294"/>
    <path class="pipe" d="M336 224V246H270V324M336 294V312H270"/>
    <circle class="body" cx="270" cy="318" r="11"/><path class="fill" d="M264 321l6 -10l6 10z"/>
    <path class="signal" d="M300 210H262V154M300 280H190V268"/>)svg";
  picture.places = {{"q_1", 52, 236, 112, 236},  {"q_2", 200, 40, 240, 88},    {"p_11", 44, 290, 152, 284},
                    {"p_12", 52, 190, 164, 246}, {"p_21", 110, 110, 216, 148}, {"p_22", 420, 158, 280, 134},
                    {"y_1", 440, 280, 372, 280}, {"y_2", 440, 210, 372, 210},  {"p_s", 400, 324, 300, 312}};
  return picture;
}

}  // namespace hydroscope
