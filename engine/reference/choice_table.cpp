// The built-in curve: milliseconds and strain of a sheet on the software driver, for devices without a saved curve of their
// own. It is the unchanged output of this command
// before there were strands, levels and patches:
//
//     weft accuracy assets/scenes/hung.json --set cloths[0].grid.cells=[99,99] --reference-cells 8 --frames 24 --save
#include <cassert>

#include "engine/reference/choice.h"

namespace weft {

Curve builtin_curve() {
  static constexpr const char* kTable = R"csv(# weft accuracy curve 1
# device: llvmpipe (LLVM 15.0.6  256 bits)
# scene: hung
# date: 2026-11-21T23:27Z
# frames: 24
# key: de9c39651bab6cc2
row,assignments,cells,particles,tethers,substeps,iterations,ms_median,ms_p95,ms_gpu,strain_mean,)csv"
                                       R"csv(strain_rms,strain_max,solver_error,time_error,total_error,non_finite,passes
jacobi,,8,81,0,1,1,0.069991,,,,0.032873448763288675,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,1,1,1,0.080802,,,,3.1330547919684476e-06,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,0,1,1,0.069343,,,,0.03391607219299595,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,8,81,1,1,1,0.076902,,,,3.1301273094062893e-06,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,0,1,1,0.1489375,,,,0.013570069801983305,,,,,0,
jacobi,,8,81,1,2,1,0.108086,,,,1.216453874768239e-06,,,,,0,
jacobi,,8,81,0,2,1,0.0988685,,,,0.0223208558631411,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,1,2,1,0.11365149999999999,,,,1.0893320540971302e-06,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,0,2,1,0.131057,,,,0.02451121168003031,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,8,81,1,2,1,0.1147455,,,,1.080397853723353e-06,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,8,81,0,2,1,0.1003455,,,,0.02567441356395557,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,0,2,1,0.253075,,,,0.0017993461237507148,,,,,0,
jacobi,,8,81,1,1,4,0.314821,,,,1.4174387656889767e-06,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,1,1,4,0.23179100000000002,,,,1.4247036265197059e-06,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,1,1,4,0.557438,,,,2.931393216960786e-06,,,,,0,
jacobi,,8,81,1,5,1,0.1984725,,,,7.551532518353145e-07,,,,,0,
jacobi,,8,81,0,5,1,0.18571549999999998,,,,0.003237583078497008,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,0,5,1,0.187261,,,,0.0047864946205831175,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,8,81,1,5,1,0.20703850000000001,,,,7.716927663531669e-07,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,8,81,0,5,1,0.185039,,,,0.005681852069318113,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,1,5,1,0.601803,,,,1.282727964235884e-06,,,,,0,
jacobi,,8,81,1,2,4,0.4265855,,,,7.098791245142748e-07,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,1,2,4,1.5444315,,,,1.145111525903537e-06,,,,,0,
jacobi,,8,81,1,10,1,0.37239,,,,7.134978599834811e-07,,,,,0,
jacobi,,8,81,0,10,1,0.325037,,,,0.0007777554439525233,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,0,10,1,2.4229345,,,,8.6359876401207e-05,,,,,0,
jacobi,,8,81,1,1,16,0.8244755,,,,6.847924058542955e-07,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,1,1,16,2.295942,,,,1.014281574650504e-06,,,,,0,
jacobi,,8,81,1,5,4,1.0020030000000002,,,,6.527784616997371e-07,,,,,0,
jacobi,,8,81,0,20,1,0.5948655,,,,0.00019130484185474935,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,0,20,1,0.5837195,,,,0.00023492214619221378,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,8,81,0,20,1,0.5809905,,,,0.00024495103827938523,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,0,20,1,3.153866,,,,2.146088872463332e-05,,,,,0,
jacobi,,8,81,1,2,16,2.060843,,,,6.403987965611585e-07,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,1,2,16,6.062461,,,,8.319435283409841e-07,,,,,0,
jacobi,,8,81,0,40,1,1.1500295,,,,4.512505066681444e-05,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,0,40,1,1.1299774999999999,,,,5.479760890335463e-05,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,0,40,1,6.7412195,,,,5.47197108337878e-06,,,,,0,
jacobi,,8,81,0,80,1,2.1786745,,,,1.0745707433716692e-05,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,0,80,1,12.419093,,,,1.4697251597802226e-06,,,,,0,
jacobi,,99,10000,0,1,1,0.6229175,,,,0.0407642065417752,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,1,1,1,0.6963515,,,,0.00015270783713373546,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,0,1,1,0.61817,,,,0.04129575101741323,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,99,10000,1,1,1,0.7062120000000001,,,,0.00015270084341683504,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,0,1,1,0.9163185,,,,0.04733730717728092,,,,,0,
jacobi,,8,81,0,160,1,5.6381295,,,,3.0912167958880338e-06,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,8,81,0,160,1,4.9631565,,,,3.840746403011259e-06,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,8,81,0,160,1,4.384212,,,,4.313355951904837e-06,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,0,160,1,24.8002405,,,,4.638333526250684e-07,,,,,0,
jacobi,,99,10000,1,2,1,1.1578855,,,,0.00015270768823371584,,,,,0,
jacobi,,99,10000,0,2,1,0.9858505,,,,0.03671195952838764,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,1,2,1,1.148852,,,,0.0001527029270007342,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,0,2,1,0.98481,,,,0.0372423340288575,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,99,10000,1,2,1,1.1593235,,,,0.0001526916158993844,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,99,10000,0,2,1,0.9805125,,,,0.0379695969614621,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,0,2,1,1.5916515,,,,0.04260880204341321,,,,,0,
jacobi,,8,81,0,320,1,9.7373255,,,,1.23107105432168e-06,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,8,81,0,320,1,8.700951,,,,1.9256777672635314e-06,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,1,320,1,45.4462515,,,,8.381580321113334e-07,,,,,0,
gauss_seidel,solver.method=gauss_seidel,8,81,0,320,1,47.82789699999999,,,,1.9532321746919728e-07,,,,,0,
jacobi,,99,10000,1,1,4,3.758775,,,,7.980106645306017e-05,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,1,1,4,3.7157035,,,,0.00010613574043701372,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,1,1,4,4.7720780000000005,,,,1.2316661307890063e-05,,,,,0,
jacobi,,99,10000,1,5,1,2.5405775,,,,0.0001461602146890257,,,,,0,
jacobi,,99,10000,0,5,1,3.154086,,,,0.03242639207703847,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,0,5,1,2.1110315,,,,0.03289926364205901,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,99,10000,1,5,1,2.5222465,,,,0.0001526830035885259,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,99,10000,0,5,1,2.105378,,,,0.03379227281860478,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,1,5,1,4.0592369999999995,,,,3.7077814806125895e-05,,,,,0,
jacobi,,99,10000,1,2,4,7.3754345,,,,7.973031395837943e-05,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,1,2,4,9.290311500000001,,,,1.0971558644874411e-05,,,,,0,
jacobi,,99,10000,1,10,1,4.7426515,,,,4.5052273425957794e-05,,,,,0,
jacobi,,99,10000,0,10,1,3.8869235,,,,0.028436707095462418,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,0,10,1,9.591838,,,,0.019891898405243507,,,,,0,
jacobi,,99,10000,1,1,16,15.637821500000001,,,,1.096944270276548e-05,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,1,1,16,18.8454475,,,,1.0448016067797143e-05,,,,,0,
jacobi,,99,10000,1,5,4,18.022233,,,,2.4448971396380072e-05,,,,,0,
jacobi,,99,10000,0,20,1,7.5275055,,,,0.022931656252223927,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,0,20,1,7.4862185,,,,0.02399906758148491,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,99,10000,0,20,1,7.522936,,,,0.02517219017511246,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,0,20,1,18.079439999999998,,,,0.0033329764468849814,,,,,0,
jacobi,,99,10000,1,2,16,45.125938000000005,,,,1.0805468104315708e-05,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,1,2,16,38.505879,,,,1.0410692566492513e-05,,,,,0,
jacobi,,99,10000,0,40,1,14.8263265,,,,0.011876705455177798,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,0,40,1,14.7316415,,,,0.014091515251765182,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,0,40,1,27.220786,,,,0.0008548806049175492,,,,,0,
jacobi,,99,10000,0,80,1,29.398454,,,,0.0017762195516250376,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,0,80,1,76.10851149999999,,,,0.00022400899663693174,,,,,0,
jacobi,,99,10000,0,160,1,58.5928445,,,,0.0006205473476561309,,,,,0,
jacobi not over-relaxed,solver.relaxation=1,99,10000,0,160,1,58.7213415,,,,0.0007800139195374192,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,99,10000,0,160,1,59.131754,,,,0.0009585269385752979,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,0,160,1,152.2294915,,,,5.5636686927834155e-05,,,,,0,
jacobi,,99,10000,0,320,1,118.55202600000001,,,,0.00024837134728894836,,,,,0,
count-averaged,solver.averaging=count solver.relaxation=1,99,10000,0,320,1,117.2795435,,,,0.0003703841116613314,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,1,320,1,247.809457,,,,1.005935797375146e-05,,,,,0,
gauss_seidel,solver.method=gauss_seidel,99,10000,0,320,1,234.578347,,,,1.528356044518594e-05,,,,,0,
)csv";
  auto curve = parse_curve(kTable);
  assert(curve);   // held by a test
  return curve ? std::move(*curve) : Curve{};
}

}  // namespace weft
