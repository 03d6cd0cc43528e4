(* The language of statements: vectors, matrices, conditions and derivatives are read away, so that plain trees are left.
   Integrals, sums, products, limits and exponentials of matrices are questions: answers.ml finds their values.
   Section 9 of docs/certificates.md. *)

open Text
open Tree

type value = Scalar of tree | Matrix of tree list list

(* The integral, sum or product of a tree over a variable, its limit at `low`, or the exponential of a matrix of n rows *)
type question = {
  kind : string;
  value : string; (* the symbol in its place; with numbers behind it for the entries of a matrix *)
  variable : string;
  terms : tree list;
  low : tree;
  high : tree;
  needs : tree list; (* what has to have a value wherever the term has to *)
  within : question list;
}

let rec change_question f q =
  { q with terms = List.map f q.terms; low = f q.low; high = f q.high; needs = List.map f q.needs; within = List.map (change_question f) q.within }

(* A random number: the name it is declared in, its mean, its covariances with the entries of this name *)
type chance = { group : string; mean : tree; row : (string * tree) list; normal : bool }

type context = {
  shapes : (string * string list list) list;
  mutable box : (string * Goal.range) list; (* the symbols, and variables of questions *)
  rates : (string * value option) list Lazy.t; (* by the name of a symbol or of a shape *)
  mutable said : tree list; (* all that is typed, and so has to have a value *)
  mutable given : tree list; (* what is supposed to be >= 0 *)
  mutable zeros : tree list; (* what is supposed to be 0 *)
  mutable known : (tree * relation * bool) list; (* conditions with their answers *)
  mutable plan : bool list; (* answers to the questions that come first in this case *)
  mutable answers : bool list; (* answers so far, the last one first *)
  mutable quiet : bool; (* in a branch that is not taken *)
  mutable branches : int; (* how many were read *)
  mutable bound : (string * string) list; (* the kinds of the questions around, by their variables *)
  mutable places : (string * tree) list; (* what stands in the place of these variables as they are typed *)
  mutable questions : question list;
  mutable fractions : (string * tree) list; (* of which numbers they are *)
  mutable floors : tree list;
  mutable chances : (string * chance) list;
}

(* Tokens *)

let read_marks = [ "!="; ">="; "<="; "**"; "="; ">"; "<"; "@"; "["; "]"; "."; "+"; "-"; "*"; "/"; "("; ")"; "," ]

let read_tokens s =
  if s = "" || String.length s > longest then refuse "expression: expected 1 to %d characters" longest;
  let n = String.length s in
  let rec name j = if j < n && (is_letter s.[j] || is_digit s.[j] || s.[j] = '_') then name (j + 1) else j in
  let starts i mark = i + String.length mark <= n && String.sub s i (String.length mark) = mark in
  let rec go i done_ =
    if i >= n then List.rev (End :: done_)
    else if s.[i] = ' ' then go (i + 1) done_
    else if is_digit s.[i] then let t, j = read_number s i in go j (t :: done_)
    else if is_letter s.[i] then let j = name i in go j (Name (String.sub s i (j - i)) :: done_)
    else
      match List.find_opt (starts i) read_marks with
      | Some mark -> go (i + String.length mark) (Mark mark :: done_)
      | None -> refuse "expression: unexpected character %C" s.[i]
  in
  go 0 []

(* Values *)

let rows_of = function Scalar t -> [ [ t ] ] | Matrix m -> m
let entries v = List.concat (rows_of v)
let scalar what = function Scalar t -> t | Matrix _ -> refuse "%s: expected a number" what
let matrix what = function Matrix m -> m | Scalar _ -> refuse "%s: expected a matrix" what

let vector what v =
  let one = function [ t ] -> t | _ -> refuse "%s: expected a vector" what in
  List.map one (matrix what v)

let width m = List.length (List.hd m)
let of_vector l = Matrix (List.map (fun t -> [ t ]) l)

let check_size n = if n < 1 || n > 64 then refuse "a matrix has 1 to 64 rows and columns"

let make_matrix m =
  check_size (List.length m);
  check_size (width m);
  if List.exists (fun row -> List.length row <> width m) m then refuse "rows of different lengths";
  Matrix m

let map f = function Scalar t -> Scalar (f t) | Matrix m -> Matrix (List.map (List.map f) m)

let shape = function Scalar _ -> (0, 0) | Matrix m -> (List.length m, width m)
let entry i j v = List.nth (List.nth (rows_of v) i) j

(* Entry by entry the tree that [make] gives of the entries of all values, which have one shape *)
let combine make values =
  let first = List.hd values in
  if List.exists (fun v -> shape v <> shape first) values then refuse "different shapes";
  match first with
  | Scalar _ -> Scalar (make (List.map (entry 0 0) values))
  | Matrix m -> Matrix (List.mapi (fun i row -> List.mapi (fun j _ -> make (List.map (entry i j) values)) row) m)

(* The whole numbers from one number to another, and a sum or product of terms *)
let list_whole low high =
  match (!constant low, !constant high) with
  | Some a, Some b when is_whole a && is_whole b ->
      if Q.geq (Q.sub b a) (Q.of_int 400) then refuse "more than 400 terms";
      List.init (max 0 (Z.to_int (Q.sub b a).Q.num + 1)) (fun i -> Num (Q.add a (Q.of_int i)))
  | _ -> refuse "expected whole ends"

let join_terms kind terms = if kind = "sum" then Sum (zero :: terms) else Prod (one :: terms)

let sum_of_parts = function [ t ] -> t | l -> Sum l
let product_of_parts = function [ t ] -> t | l -> Prod l

(* Numbers and at most one matrix *)
let multiply values =
  let is_matrix = function Matrix _ -> true | Scalar _ -> false in
  match List.filter is_matrix values with
  | [] -> Scalar (product_of_parts (List.map (scalar "product") values))
  | [ (Matrix _ as m) ] ->
      let with_entry t = product_of_parts (List.map (function Scalar s -> s | Matrix _ -> t) values) in
      map with_entry m
  | _ -> refuse "products of matrices are written with @"

let transpose m = List.init (width m) (fun j -> List.map (fun row -> List.nth row j) m)

let times a b =
  let a = matrix "@" a and b = matrix "@" b in
  if width a <> List.length b then refuse "@: different sizes";
  let columns = transpose b in
  let entry row column = sum_of_parts (List.map2 (fun x y -> Prod [ x; y ]) row column) in
  match List.map (fun row -> List.map (entry row) columns) a with [ [ t ] ] -> Scalar t | m -> Matrix m

let square most what v =
  let m = matrix what v in
  if List.length m <> width m || width m > most then refuse "%s: expected a square matrix of at most %d rows" what most;
  m

let without k l = List.filteri (fun i _ -> i <> k) l
let minor i j m = List.map (without j) (without i m)
let odd_negated k t = if k land 1 = 1 then negate t else t

let rec determinant m =
  match m with
  | [] -> one
  | [ [ a ] ] -> a
  | row :: _ -> sum_of_parts (List.mapi (fun j a -> odd_negated j (Prod [ a; determinant (minor 0 j m) ])) row)

let inverse m =
  let below = Pow (determinant m, Num Q.minus_one) in
  let entry i j = Prod [ odd_negated (i + j) (determinant (minor j i m)); below ] in
  let n = List.length m in
  Matrix (List.init n (fun i -> List.init n (entry i)))

let product a b = Prod [ a; b ]

let cross u v =
  match (u, v) with
  | [ u1; u2; u3 ], [ v1; v2; v3 ] ->
      let pair a b c d = subtract (product a b) (product c d) in
      [ pair u2 v3 u3 v2; pair u3 v1 u1 v3; pair u1 v2 u2 v1 ]
  | _ -> refuse "cross: expected vectors of 3 entries"

let dot u v =
  if List.length u <> List.length v then refuse "dot: different shapes";
  sum_of_parts (List.map2 product u v)

let qmul p q =
  match (p, q) with
  | a :: u, b :: v when List.length u = 3 && List.length v = 3 ->
      let join x y z = Sum [ product a x; product b y; z ] in
      subtract (product a b) (dot u v) :: List.map2 (fun (x, y) z -> join y x z) (List.combine u v) (cross u v)
  | _ -> refuse "qmul: expected vectors of 4 entries"

let rotation = function
  | [ w; x; y; z ] ->
      let p = product in
      let twice s = Prod [ number 2; s ] in
      let plus a b = twice (Sum [ a; b ]) and less a b = twice (subtract a b) in
      let diagonal a b c d = Sum [ p a a; p b b; negate (p c c); negate (p d d) ] in
      [
        [ diagonal w x y z; less (p x y) (p w z); plus (p x z) (p w y) ];
        [ plus (p x y) (p w z); diagonal w y x z; less (p y z) (p w x) ];
        [ less (p x z) (p w y); plus (p y z) (p w x); diagonal w z x y ];
      ]
  | _ -> refuse "rot: expected a vector of 4 entries"

let skew = function
  | [ a; b; c ] -> [ [ zero; negate c; b ]; [ c; zero; negate a ]; [ negate b; a; zero ] ]
  | _ -> refuse "skew: expected a vector of 3 entries"

let size_of what = function
  | Scalar (Num q) when is_whole q && Q.sign q > 0 && Q.leq q (Q.of_int 64) -> Z.to_int q.Q.num
  | _ -> refuse "%s: expected a literal size from 1 to 64" what

let diagonal l = Matrix (List.mapi (fun i t -> List.mapi (fun j _ -> if i = j then t else zero) l) l)

let matrix_function name args =
  let v what = vector what in
  match (name, args) with
  | "transpose", [ a ] -> Some (Matrix (transpose (matrix name a)))
  | "cross", [ a; b ] -> Some (of_vector (cross (v name a) (v name b)))
  | "dot", [ a; b ] -> Some (Scalar (dot (v name a) (v name b)))
  | "norm", [ a ] -> let u = v name a in Some (Scalar (apply "sqrt" (dot u u)))
  | "skew", [ a ] -> Some (Matrix (skew (v name a)))
  | "det", [ a ] -> Some (Scalar (determinant (square 5 name a)))
  | "inv", [ a ] -> Some (inverse (square 4 name a))
  | "trace", [ a ] -> Some (Scalar (sum_of_parts (List.mapi (fun i row -> List.nth row i) (square 64 name a))))
  | "eye", [ n ] -> Some (diagonal (List.init (size_of name n) (fun _ -> one)))
  | "zeros", [ m; n ] ->
      let m = size_of name m and n = size_of name n in
      Some (Matrix (List.init m (fun _ -> List.init n (fun _ -> zero))))
  | "diag", [ (Matrix _ as u) ] -> Some (diagonal (v name u))
  | "diag", (_ :: _ as l) -> Some (diagonal (List.map (scalar name) l))
  | "qmul", [ p; q ] -> Some (of_vector (qmul (v name p) (v name q)))
  | "conj", [ q ] -> (
      match v name q with
      | w :: l when List.length l = 3 -> Some (of_vector (w :: List.map negate l))
      | _ -> refuse "conj: expected a vector of 4 entries")
  | "rot", [ q ] -> Some (Matrix (rotation (v name q)))
  | _ -> None

(* Derivatives *)

let say context t =
  match t with
  | Num _ | Sym _ -> ()
  | _ -> if not (context.quiet || List.mem t context.said) then context.said <- t :: context.said

(* f has to have a value and to be differentiable. *)
let existing = function
  | Above, t -> apply "log" t
  | AtLeast, t -> apply "sqrt" t
  | _, t -> Pow (t, Num Q.minus_one)

let say_smooth context f =
  say context f;
  List.iter (fun c -> say context (existing c)) (conditions 2 [ f ])

(* The value of a question has a blank in its name. *)
let is_asked t = Names.exists (fun s -> String.contains s ' ') (symbols t)

let check_plain context what t =
  if is_asked t then refuse "%s of an integral, sum, product or limit" what;
  if Names.exists (fun s -> List.mem_assoc s context.fractions) (symbols t) then refuse "%s of a floor" what

let check_real context s =
  match List.assoc_opt s context.box with Some r when r.Goal.integer -> refuse "a whole number that varies" | _ -> ()

let rates_by_symbol context =
  let one (name, rate) =
    match List.assoc_opt name context.shapes with
    | None -> [ (name, Option.map (scalar "rates") rate) ]
    | Some rows ->
        let names = List.concat rows in
        let values = match rate with None -> List.map (fun _ -> None) names | Some v -> List.map Option.some (entries v) in
        List.combine names values
  in
  let all = List.concat_map one (Lazy.force context.rates) in
  let names = List.map fst all in
  if List.length (List.sort_uniq compare names) <> List.length names then refuse "rates: one symbol has one rate";
  all

let derive_by_time context f =
  check_plain context "a derivative" f;
  say_smooth context f;
  let rates = rates_by_symbol context in
  let share s =
    match List.assoc_opt s rates with
    | None -> zero
    | Some None -> refuse "no rate is known of %s" s
    | Some (Some rate) ->
        check_real context s;
        say context rate;
        let slope = Calculus.derive s f in
        if equal slope zero || equal rate zero then zero else Calculus.product' [ slope; rate ]
  in
  Calculus.sum' (List.map share (Names.elements (symbols f)))

let derive_by_symbol context s times f =
  let has_rate = s = "t" && List.mem_assoc s (Lazy.force context.rates) in
  let rec go n f =
    if n = 0 then f
    else if has_rate then go (n - 1) (derive_by_time context f)
    else begin
      check_real context s;
      say_smooth context f;
      go (n - 1) (Calculus.derive s f)
    end
  in
  check_plain context "a derivative" f;
  go times f

(* Suppositions *)

let join t l = if List.mem t l then l else l @ [ t ]

let distance a b = match (a, b) with a, Num q when Q.sign q = 0 -> a | Num q, b when Q.sign q = 0 -> negate b | _ -> subtract a b

(* Supposes d relation 0. *)
let suppose_sign context d relation =
  say context d;
  (match relation with
  | Equal -> context.zeros <- join d context.zeros
  | Unequal -> ()
  | AtLeast | Above -> context.given <- join d context.given);
  if relation = Above || relation = Unequal then say context (Pow (d, Num Q.minus_one))

let opposite_of d = function
  | Equal -> (d, Unequal)
  | Unequal -> (d, Equal)
  | Above -> (negate d, AtLeast)
  | AtLeast -> (negate d, Above)

(* A condition as d relation 0, or its opposite *)
let read_relation mark x y =
  match mark with
  | "=" -> (distance x y, Equal)
  | "!=" -> (distance x y, Unequal)
  | ">" -> (distance x y, Above)
  | ">=" -> (distance x y, AtLeast)
  | "<" -> (distance y x, Above)
  | _ -> (distance y x, AtLeast)

let suppose context (x, mark, y) =
  match (x, mark, y) with
  | _, "=", _ ->
      let all = combine (function [ a; b ] -> distance a b | _ -> assert false) [ x; y ] in
      List.iter (fun d -> suppose_sign context d Equal) (entries all)
  | Scalar x, mark, Scalar y ->
      let d, relation = read_relation mark x y in
      suppose_sign context d relation
  | _ -> refuse "given: matrices have no other relation"

(* Cases: the answer to the question whether d relation 0 holds *)

(* The answer that follows from another condition on the same number, or on the one with the other sign: [`Ask_zero sign] where
   it is the answer to d = 0, or for the sign false the opposite. *)
let recall context d relation =
  let follows (other_tree, other, taken) =
    let same = Algebra.vanishes (subtract d other_tree) in
    if not (same || Algebra.vanishes (Sum [ d; other_tree ])) then None
    else if other = Equal || relation = Equal then if other = relation then Some (`Answer taken) else None
    else
      let sharp = other = if taken then Above else AtLeast in
      if same = taken then Some (if sharp || relation = AtLeast then `Answer true else `Ask_zero false)
      else Some (if sharp || relation = Above then `Answer false else `Ask_zero true)
  in
  List.find_map follows (List.rev context.known)

let rec ask context d relation =
  if Names.exists (fun s -> List.mem_assoc s context.bound) (symbols d) then refuse "cases of a bound variable";
  if relation = Unequal then not (ask context d Equal)
  else begin
    context.branches <- context.branches + 1;
    if context.quiet then true
    else if context.bound <> [] || context.places <> [] then if has_symbols d then ask_case context d relation else sign_holds d relation
    else ask_case context d relation
  end

(* Below a question a number without symbols makes no case. *)
and sign_holds d relation =
  match Value.finite_ball Value.no_symbols d with
  | Some x when Ball.is_above x -> relation <> Equal
  | Some x when Ball.is_below x -> false
  | Some _ when Algebra.vanishes d -> relation <> Above
  | _ -> refuse "a number whose sign is not known"

and ask_case context d relation =
  match recall context d relation with
  | Some (`Answer answer) -> say context d; answer
  | Some (`Ask_zero sign) -> say context d; ask context d Equal = sign
  | None ->
      let answer = match context.plan with [] -> true | a :: rest -> context.plan <- rest; a in
      context.answers <- answer :: context.answers;
      if List.length context.answers > 128 then refuse "more than 128 cases";
      context.known <- (d, relation, answer) :: context.known;
      let d, relation = if answer then (d, relation) else opposite_of d relation in
      suppose_sign context d relation;
      answer

(* The plan of the next case, if there is one: the last yes becomes a no. *)
let rec next_plan = function [] -> None | false :: earlier -> next_plan earlier | true :: earlier -> Some (List.rev (false :: earlier))

(* Whether a number has the variable of an integral, which does not see where it is 0 *)
let has_sides context x = Names.exists (fun s -> List.assoc_opt s context.bound = Some "integral") (symbols x)

let choose context name args =
  let chosen x y =
    if context.bound <> [] then
      let gap = apply "abs" (subtract x y) in
      Prod [ Num (Q.of_ints 1 2); Sum [ x; y; (if name = "max" then gap else negate gap) ] ]
    else
      let first = ask context (subtract y x) AtLeast in
      if (name = "min") = first then x else y
  in
  match (name, args) with
  | "sign", [ x ] when has_sides context x -> Prod [ x; Pow (apply "abs" x, Num Q.minus_one) ]
  | "sign", [ x ] -> if ask context x Equal then zero else if ask context x Above then one else number (-1)
  | ("min" | "max"), (x :: (_ :: _ as rest)) -> List.fold_left chosen x rest
  | _ -> refuse "%s: another number of arguments" name

(* Whole parts *)

let rec is_integral box floors t =
  List.mem t floors
  ||
  match t with
  | Sym s -> ( match List.assoc_opt s box with Some r -> r.Goal.integer | None -> false)
  | Sum l | Prod l -> List.for_all (is_integral box floors) l
  | Num q -> is_whole q
  | _ -> false

(* The whole n with n <= u < n + 1, for a tree without symbols *)
let find_whole u =
  let ball t = match Value.finite_ball Value.no_symbols t with Some x -> x | None -> refuse "a number that may not exist" in
  let near = match (ball u).lo with Ball.At (m, e) -> Z.to_int (if e >= 0 then Z.shift_left m e else Z.shift_right m (-e)) | _ -> 0 in
  let fits n =
    let rest = subtract u (number n) in
    let x = ball rest in
    Ball.is_above (Ball.less Ball.ball_one x) && (Ball.sign_of x.lo >= 0 || Algebra.vanishes rest)
  in
  match List.find_opt fits [ near; near + 1 ] with Some n -> n | None -> refuse "a number whose whole part is not known"

(* floor(x) is x - f with a symbol f, 0 <= f < 1; whole terms come out first. *)
let find_floor context x =
  say context x;
  let rec terms t = match t with Sum l when not (List.mem t context.floors) -> List.concat_map terms l | _ -> [ t ] in
  let whole, rest = List.partition (is_integral context.box context.floors) (terms x) in
  let floor_of t = sum_of_parts (whole @ [ t ]) in
  if context.quiet || rest = [] then x
  else
    let u = sum_of_parts rest in
    if Names.exists (fun s -> List.mem_assoc s context.bound) (symbols u) then refuse "a floor of a bound variable";
    if not (has_symbols u) then floor_of (number (find_whole u))
    else
      let at_ends side =
        let ends = List.filter_map (fun (s, r) -> Option.map (fun t -> (s, t)) (side r)) context.box in
        let t = put ends u and far = Ball.of_int 1_000_000_000 in
        match if has_symbols t then None else Value.finite_ball Value.no_symbols t with
        | Some x when Ball.is_above (Ball.less far (Ball.size x)) -> [ find_whole t ]
        | _ -> []
      in
      let above n = subtract u (number n) and below n = subtract (number n) u in
      let rec first n high = if n > high then None else if ask context (below (n + 1)) Above then Some n else first (n + 1) high in
      let is_new d = context.answers = [] || recall context d AtLeast <> None in
      let known =
        match List.sort compare (at_ends (fun r -> r.Goal.low) @ at_ends (fun r -> r.Goal.high)) with
        | [ low; high ] when high - low < 4 && is_new (above low) && ask context (above low) AtLeast -> first low high
        | _ -> None
      in
      match known with
      | Some n -> floor_of (number n)
      | None ->
          let own = Printf.sprintf "fraction__%d" (List.length context.fractions + 1) in
          let same (_, v) = Algebra.vanishes (subtract u v) in
          let name = match List.find_opt same context.fractions with Some (f, _) -> f | None -> own in
          if List.mem_assoc name context.box then refuse "a name that is in use";
          if name = own then context.fractions <- context.fractions @ [ (name, u) ];
          let value = subtract u (Sym name) in
          context.floors <- value :: context.floors;
          floor_of value

(* Expectations of polynomials in random numbers *)

let is_random context s = List.mem_assoc s context.chances
let meets_random context t = Names.exists (is_random context) (symbols t)

let rec moment context = function
  | [] -> one
  | first :: others as word ->
      let own = List.assoc first context.chances in
      let inside, outside_ = List.partition (fun s -> (List.assoc s context.chances).group = own.group) others in
      if List.length word > 8 || not (own.normal || List.length inside < 2) then refuse "a moment that is not declared";
      let pair k s = Prod [ List.assoc s own.row; moment context (List.filteri (fun i _ -> i <> k) inside) ] in
      Prod [ Sum (Prod [ own.mean; moment context inside ] :: List.mapi pair inside); moment context outside_ ]

let expect context t =
  check_plain context "an expectation" t;
  let see (r, c) =
    if meets_random context c then refuse "a random number below a line or in a function";
    say context (existing (r, c))
  in
  List.iter see (conditions 0 [ t ]);
  let fixed part = (match part with Sym _ -> () | _ -> if meets_random context part then refuse "a random number in a function") in
  let order = Algebra.generators t in
  List.iter fixed order;
  let rec place_of t i = function [] -> i | g :: l -> if equal g t then i else place_of t (i + 1) l in
  let part i = match Algebra.atom_of i with Algebra.Part t -> t | _ -> assert false in
  let one_term (m, c) =
    let random, others = List.partition (fun (i, _) -> match part i with Sym s -> is_random context s | _ -> false) m in
    let random = List.sort (fun (i, _) (j, _) -> compare (place_of (part i) 0 order) (place_of (part j) 0 order)) random in
    let repeat (i, q) =
      match part i with
      | Sym s when is_whole q && Q.sign q > 0 -> List.init (Z.to_int q.Q.num) (fun _ -> s)
      | _ -> refuse "a random number below a line"
    in
    let powers = List.map (fun (i, q) -> Pow (part i, Num q)) others in
    Prod ((Num c :: powers) @ [ moment context (List.concat_map repeat random) ])
  in
  let write terms = Sum (zero :: List.map one_term terms) in
  let over, under = Algebra.split_quotient t in
  let below (p, n) =
    let t = write p in
    if meets_random context t || List.exists (fun (m, _) -> List.exists (fun (i, _) -> meets_random context (part i)) m) p then refuse "a random number below a line";
    Pow (t, number (-n))
  in
  Prod (write over :: List.map below under)

let covariance context x y =
  let centred v = map (fun t -> subtract t (expect context t)) v in
  match (centred x, centred y) with
  | (Matrix _ as u), (Matrix v as w) ->
      ignore (vector "cov" u); ignore (vector "cov" w);
      map (expect context) (times u (Matrix (transpose v)))
  | u, v -> Scalar (expect context (Prod [ scalar "cov" u; scalar "cov" v ]))

let read_chances context read random =
  let declare (group, item) =
    match get_keys "random" [ "mean"; "cov"; "normal" ] item with
    | [ mean; cov; normal ] ->
        let names = match List.assoc_opt group context.shapes with Some rows -> List.concat rows | None -> [ group ] in
        let m = entries (read (get_text "mean" mean)) and rows = rows_of (read (get_text "cov" cov)) in
        let n = List.length names in
        let normal = match normal with Bool b -> b | _ -> refuse "normal: expected true or false" in
        if n > 4 || List.length m <> n || List.length rows <> n || width rows <> n then
          refuse "expected a mean and a covariance for up to 4 numbers";
        let is_taken s = is_random context s || List.mem_assoc s context.box in
        if List.exists is_taken names || List.length (List.sort_uniq compare names) < n then refuse "random: a name given twice";
        List.iter (say context) m;
        let rec choices k from = if k = 0 then [ [] ] else if from >= n then [] else
          List.map (List.cons from) (choices (k - 1) (from + 1)) @ choices k (from + 1) in
        let entry i j = List.nth (List.nth rows i) j in
        let minor places = determinant (List.map (fun i -> List.map (entry i) places) places) in
        for k = 1 to n do List.iter (fun places -> suppose_sign context (minor places) AtLeast) (choices k 0) done;
        let same i j = if equal (entry i j) (entry j i) then zero else subtract (entry i j) (entry j i) in
        List.iteri (fun i _ -> List.iteri (fun j _ -> if i < j then suppose_sign context (same i j) Equal) names) names;
        let chance i name = (name, { group; mean = List.nth m i; row = List.combine names (List.nth rows i); normal }) in
        context.chances <- context.chances @ List.mapi chance names
    | _ -> assert false
  in
  List.iter declare random

(* Exponentials of matrices *)
let ask_exponential context a =
  let rows = square 16 "expm" a in
  let n = List.length rows and number = List.length context.questions + 1 in
  List.iter (say context) (entries a);
  List.iter (check_plain context "an exponential") (entries a);
  if context.quiet then a
  else begin
    let value = Printf.sprintf "value %d" number in
    let q = { kind = "expm"; value; variable = Printf.sprintf "s__%d" number; terms = entries a; low = zero; high = one; needs = []; within = [] } in
    context.questions <- context.questions @ [ q ];
    Matrix (List.init n (fun i -> List.init n (fun j -> Sym (Printf.sprintf "%s %d %d" value i j))))
  end

let relation_marks = [ "="; "!="; ">"; ">="; "<"; "<=" ]

let call context name args =
  match (name, args) with
  | "dot_", [ f ] -> map (derive_by_time context) f
  | "diff", f :: Scalar (Sym s) :: times when not (is_asked (Sym s)) ->
      let n = match times with [] -> 1 | [ n ] -> size_of name n | _ -> refuse "diff: another number of arguments" in
      if n > 8 then refuse "diff: a derivative of a high order";
      map (derive_by_symbol context s n) f
  | "E", [ f ] -> map (expect context) f
  | "cov", [ f ] -> covariance context f f
  | "cov", [ f; g ] -> covariance context f g
  | "expm", [ a ] -> ask_exponential context a
  | "floor", [ Scalar x ] -> Scalar (find_floor context x)
  | _ -> (
      match matrix_function name args with
      | Some v -> v
      | None ->
          if arguments_of name <> List.length args then refuse "expression: %s with %d arguments" name (List.length args);
          Scalar (Fun (name, List.map (scalar name) args)))

(* Grammar *)

let rec read_sum context r =
  let first = read_product context r in
  let rec go parts =
    match next r with
    | Mark "+" -> drop r; let v = read_product context r in go (v :: parts)
    | Mark "-" -> drop r; let v = read_product context r in go (map negate v :: parts)
    | _ -> List.rev parts
  in
  combine sum_of_parts (go [ first ])

and read_product context r =
  let rec go factors =
    match next r with
    | Mark "*" -> drop r; let v = read_signed context r in go (v :: factors)
    | Mark "/" ->
        drop r;
        let v = scalar "a divisor" (read_signed context r) in
        go (Scalar (Pow (v, Num Q.minus_one)) :: factors)
    | Mark "@" ->
        drop r;
        let left = typed context (multiply (List.rev factors)) in
        let right = read_signed context r in
        go [ typed context (times left right) ]
    | _ -> ( match factors with [ v ] -> v | l -> multiply (List.rev l))
  in
  go [ read_signed context r ]

and read_signed context r =
  match next r with
  | Mark "+" -> drop r; deeper r (read_signed context)
  | Mark "-" -> drop r; map negate (deeper r (read_signed context))
  | _ ->
      let base = read_entry context r in
      if next r = Mark "**" then begin
        drop r;
        let exponent = deeper r (read_signed context) in
        Scalar (Pow (scalar "a base" base, scalar "an exponent" exponent))
      end
      else base

and read_entry context r =
  let rec go v =
    match next r with
    | Mark "." ->
        drop r;
        if next r <> Name "T" then refuse "expression: expected .T";
        drop r;
        go (Matrix (transpose (matrix ".T" v)))
    | Mark "[" -> drop r; go (Scalar (read_index r v))
    | _ -> v
  in
  go (typed context (read_value context r))

(* All entries of a matrix that is typed have to have a value. *)
and typed context v =
  (match v with Matrix m -> List.iter (List.iter (say context)) m | Scalar _ -> ());
  v

and read_index r v =
  let literal () =
    match next r with
    | Number q when is_whole q && Q.sign q > 0 && Q.leq q (Q.of_int 64) -> drop r; Z.to_int q.Q.num - 1
    | _ -> refuse "an index is a literal number from 1"
  in
  let m = matrix "an index" v in
  let i = literal () in
  let j = if next r = Mark "," then (drop r; literal ()) else if width m = 1 then 0 else refuse "a matrix has two indices" in
  take r "]";
  match Option.bind (List.nth_opt m i) (fun row -> List.nth_opt row j) with
  | Some t -> t
  | None -> refuse "an index beyond the matrix"

and read_value context r =
  match next r with
  | Number q -> drop r; Scalar (Num q)
  | Mark "(" ->
      drop r;
      let v = deeper r (read_sum context) in
      take r ")"; v
  | Mark "[" -> drop r; deeper r (read_rows context)
  | Name name -> (
      drop r;
      match next r with
      | Mark "(" ->
          drop r;
          if name = "where" then read_where context r
          else if List.mem name [ "integral"; "sum"; "product"; "limit" ] then read_question context name r
          else if List.mem name [ "min"; "max"; "sign" ] then Scalar (choose context name (List.map (scalar name) (read_list context r ")")))
          else begin
            let before = context.branches and around = context.bound and is_derivative = List.mem name [ "diff"; "dot_" ] in
            if is_derivative then context.bound <- ("", name) :: around;
            let args = List.map (typed context) (read_list context r ")") in
            context.bound <- around;
            if is_derivative && context.branches > before then refuse "a derivative of cases";
            call context name args
          end
      | _ when name = "pi" -> Scalar Pi
      | _ -> (
          if String.starts_with ~prefix:"fraction__" name then refuse "a name that is in use";
          match (List.assoc_opt name context.places, List.assoc_opt name context.shapes) with
          | Some t, _ -> Scalar t
          | None, Some rows -> Matrix (List.map (List.map (fun s -> Sym s)) rows)
          | None, None -> Scalar (Sym name)))
  | _ -> refuse "expression: expected a number, a name or a parenthesis"

(* The tokens up to the first comma, which is taken *)
and cut_body r =
  let rec go depth body =
    let t = next r in
    drop r;
    match t with
    | End -> refuse "expression: expected a comma"
    | Mark "," when depth = 0 -> List.rev (End :: body)
    | Mark ("(" | "[") -> go (depth + 1) (t :: body)
    | Mark (")" | "]") -> go (depth - 1) (t :: body)
    | _ -> go depth (t :: body)
  in
  go 0 []

(* What stands there with a value in the place of a name, and what has to have a value for it *)
and read_body context depth kind body name value =
  let { said; bound; box; places; _ } = context in
  context.said <- [];
  context.places <- (name, value) :: places;
  (match value with
  | Sym v ->
      context.bound <- (v, kind) :: bound;
      context.box <- (v, { Goal.anything with integer = kind = "sum" || kind = "product" }) :: box
  | _ -> ());
  let r = { rest = body; depth } in
  let v = deeper r (read_sum context) in
  if next r <> End then refuse "%s: expected a variable" kind;
  let needs = List.rev context.said in
  context.said <- said;
  context.bound <- bound;
  context.box <- box;
  context.places <- places;
  (v, needs)

(* integral(f, x, a, b), sum and product the same, limit(f, x, a): a symbol for each entry of f, or all terms *)
and read_question context kind r =
  let first = List.length context.questions and whole = kind = "sum" || kind = "product" in
  let body = cut_body r in
  let k = match next r with Name k when k <> "pi" && k <> "oo" -> drop r; k | _ -> refuse "%s: expected a variable" kind in
  if List.mem_assoc k context.shapes || List.mem_assoc k (Lazy.force context.rates) || is_random context k then
    refuse "%s: a variable that is in use" kind;
  let variable = Printf.sprintf "%s'%d" k (List.length context.bound) in
  let read = read_body context r.depth kind body k in
  let early = if whole then None else Some (read (Sym variable)) in
  take r ",";
  let ends = List.map (scalar kind) (read_list context r ")") in
  if List.length ends <> if kind = "limit" then 1 else 2 then refuse "%s: another number of ends" kind;
  let low = List.hd ends and high = List.nth ends (List.length ends - 1) in
  match (whole, !constant low, !constant high) with
  | true, Some _, Some _ ->
      let term k =
        let v, needs = read k in
        List.iter (say context) (entries v @ needs);
        if kind = "sum" then v else Scalar (scalar kind v)
      in
      let numbers = list_whole low high in
      if numbers = [] then Scalar (join_terms kind [])
      else combine (join_terms kind) (List.rev (List.fold_left (fun l k -> term k :: l) [] numbers))
  | _ ->
      let v, needs = match early with Some found -> found | None -> read (Sym variable) in
      if context.fractions <> [] then refuse "%s beside a floor" kind;
      if kind = "product" then ignore (scalar kind v);
      let own_needs, others = List.partition (fun t -> Names.mem variable (symbols t)) needs in
      if not context.quiet then List.iter (say context) others;
      let own = Printf.sprintf "%s__%d" k (List.length context.questions + 1) in
      let change = put [ (variable, Sym own) ] in
      let around = { kind; value = ""; variable = own; terms = []; low; high; needs = List.map change own_needs; within = [] } in
      let put_inside i inner = if i < first then inner else
        let inner = change_question change inner in { inner with within = inner.within @ [ around ] } in
      context.questions <- List.mapi put_inside context.questions;
      let ask t =
        let value = Printf.sprintf "value %d" (List.length context.questions + 1) in
        context.questions <- context.questions @ [ { around with value; terms = [ change t ] } ];
        Sym value
      in
      map (fun t -> if context.quiet then zero else ask t) v

(* where(condition, a, b): what is read in the branch that is not taken leaves no trace. *)
and read_where context r =
  let side () = scalar "a condition" (deeper r (read_sum context)) in
  let x = side () in
  let mark = match next r with Mark m when List.mem m relation_marks -> drop r; m | _ -> refuse "where: expected a relation" in
  let y = side () in
  let d, relation = read_relation mark x y in
  let has_sides = has_sides context in
  let answer = if (relation = Above || relation = AtLeast) && has_sides d then None else Some (ask context d relation) in
  let known () = (context.said, List.length context.questions, context.answers) in
  let before = known () in
  let branch is_first =
    take r ",";
    let quiet = context.quiet in
    context.quiet <- quiet || answer = Some (not is_first);
    let v = typed context (deeper r (read_sum context)) in
    context.quiet <- quiet;
    v
  in
  let a = branch true in
  let b = branch false in
  take r ")";
  if shape a <> shape b then refuse "where: different shapes";
  match answer with
  | Some first -> if first then a else b
  | None ->
      let plain = List.for_all (fun (_, t) -> has_sides t) (conditions 0 (entries a @ entries b)) in
      if not (plain && known () = before) then refuse "a branch that may have no value";
      let side = Prod [ d; Pow (apply "abs" d, Num Q.minus_one) ] in
      let join = function [ a; b ] -> Prod [ Num (Q.of_ints 1 2); Sum [ a; b; Prod [ subtract a b; side ] ] ] | _ -> assert false in
      combine join [ a; b ]

(* Values up to a closing mark *)
and read_list context r closing =
  let rec go done_ =
    let done_ = deeper r (read_sum context) :: done_ in
    if next r = Mark "," then (drop r; go done_) else (take r closing; List.rev done_)
  in
  go []

and read_rows context r =
  let numbers () = List.map (scalar "an entry") (read_list context r "]") in
  if next r <> Mark "[" then make_matrix (List.map (fun t -> [ t ]) (numbers ()))
  else
    let rec go done_ =
      take r "[";
      let done_ = numbers () :: done_ in
      if next r = Mark "," then (drop r; go done_) else (take r "]"; List.rev done_)
    in
    make_matrix (go [])

let say_value context v =
  List.iter (say context) (entries v);
  v

let read_value_of context text =
  let r = { rest = read_tokens text; depth = 0 } in
  let v = read_sum context r in
  if next r <> End then refuse "expression: expected an operator";
  say_value context v

(* The two sides of a condition and its relation *)
let read_condition context text =
  let r = { rest = read_tokens text; depth = 0 } in
  let x = read_sum context r in
  let mark =
    match next r with
    | Mark (("=" | "!=" | ">" | ">=" | "<" | "<=") as m) -> drop r; m
    | _ -> refuse "given: expected a relation"
  in
  let y = read_sum context r in
  if next r <> End then refuse "given: expected the end of the condition";
  (say_value context x, mark, say_value context y)

(* Declarations *)

let read_shapes declared random value =
  let read (name, rows) =
    if (not (is_name name)) || List.mem name declared then refuse "shapes: expected a new name, got %S" name;
    let entry v =
      let s = get_name "shapes" v in
      if List.mem s declared <> List.mem_assoc name random then s else refuse "shapes: unknown symbol %s" s
    in
    let rows = List.map (fun row -> List.map entry (get_list name row)) (get_list name rows) in
    if rows = [] || List.hd rows = [] then refuse "shapes: expected rows";
    ignore (make_matrix (List.map (List.map (fun s -> Sym s)) rows));
    (name, rows)
  in
  List.map read (get_object "shapes" value)

let read_rates context value =
  let read (name, rate) =
    let declared_value =
      match List.assoc_opt name context.shapes with
      | Some rows -> Matrix (List.map (List.map (fun s -> Sym s)) rows)
      | None -> Scalar (Sym name)
    in
    match rate with
    | Null -> (name, None)
    | v ->
        let alone = { context with said = []; rates = lazy [] } in
        let rate = read_value_of alone (get_text "rates" v) in
        if alone.branches > 0 then refuse "a rate of cases";
        if alone.questions <> [] || alone.fractions <> [] then outside "a rate with a question or a whole part";
        if shape rate <> shape declared_value then refuse "rates: different shapes";
        (name, Some rate)
  in
  List.map read (get_object "rates" value)

let make_context box plan shapes rates random =
  let shapes = read_shapes (List.map fst box) random shapes in
  let rec context =
    { shapes; box; rates = lazy (read_rates context rates); said = []; given = []; zeros = []; known = []; plan; answers = [];
      quiet = false; branches = 0; bound = []; places = []; questions = []; fractions = []; floors = []; chances = [] }
  in
  ignore (Lazy.force context.rates);
  read_chances context (read_value_of context) random;
  context
